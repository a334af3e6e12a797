#include <iostream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/report/camera_key_numbers.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/replacement.h"
#include "importer/layout/layout_writer.h"
#include "importer/print/marker_sheets.h"
#include "importer/print/png_file.h"
#include "importer/text/id_ranges.h"
#include "workflows/check/clip_check.h"
#include "workflows/check/clip_limits.h"
#include "workflows/check/clip_verdict.h"
#include "workflows/commands/commands.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/shared_options.h"
#include "workflows/proposal/layout_proposal.h"

namespace velamap {
namespace {

struct ClipCheckerCommandOptions : CommandOptions {
  std::string proposed_layout_path;
  ClipCheckOptions check;
};

CommandSyntax Declare(ClipCheckerCommandOptions* options) {
  PathOptions* paths = &options->paths;
  return {
      "clip_checker",
      "checks before a reconstruction whether a clip is good enough",
      "--image_path clip.mp4 --layout_path layout.yml --camera_path camera.yml \\\n"
      "    --output_path frame.png --proposed_layout_path corrected.yml",
      {{"Input and output",
        {ImagePathOption(paths),
         Common(PathOption("camera_path", PathUse::kReadsFile, &paths->camera_path,
                           "calibration of the camera, for the precision, which also needs the "
                           "markers' sizes (--layout_path, or --marker_length and --dictionary), "
                           "and for --proposed_layout_path; left out: the camera is found from the "
                           "pictures")),
         Common(PathOption("output_path", PathUse::kWritesFile, &paths->output_path,
                           "PNG of the frame with most markers, with their outlines and ids; left "
                           "out: none")),
         Common(PathOption(
             "proposed_layout_path", PathUse::kWritesOwnFile, &options->proposed_layout_path,
             "layout file with the parts, lines and lengths that the clip shows, or the "
             "given layout corrected, which takes as long as a reconstruction; left out: none")),
         {"num_frames", &options->check.num_frames, "frames",
          "maximum number of frames of a video to look at, spread evenly over all of it",
          FromTo(5, 1000)}}},
       DescribeOptions(&options->markers, true),
       DescribeOptions(&options->check.detection),
       DescribeOptions(&options->check.video),
       DescribeOptions(&options->general)}};
}

void RefuseUnusedOptions(const ClipCheckerCommandOptions& options) {
  RefuseVideoOptions(options);
  if (IsFolder(options.paths.image_path)) {
    RefuseOptionsWithoutEffect(options.typed, {"num_frames"}, "all photographs are looked at");
  }
  if (!HasMarkerOptions(options.markers) && options.proposed_layout_path.empty()) {
    WarnOfOptionsWithoutEffect(
        options.typed, {"camera_path"},
        "the precision cannot be predicted without the markers' sizes (--layout_path, or "
        "--marker_length and --dictionary)");
  }
}

// Without this check, a PNG could replace a photograph and keep its name, such as a.jpg.
void CheckPictureName(const std::string& path) {
  if (path.empty() || LowerExtension(path) == ".png") return;
  throw InputError(fmt::format(
      "--output_path: {} does not end in .png, and the picture is a PNG; give a name such as "
      "frame.png",
      path));
}

void Validate(ClipCheckerCommandOptions* options) {
  ClipCheckOptions& check = options->check;
  CheckPictureName(options->paths.output_path);
  RefuseUnusedOptions(*options);
  check.detection.Check();
  check.video.Check();
  check.image_path = options->paths.image_path;
  check.num_threads = options->general.num_threads;
  check.layout = LoadGivenLayout(options->markers, true);
  check.camera = LoadCalibration(options->paths);
  check.camera_path = options->paths.camera_path;
  check.proposes_layout = !options->proposed_layout_path.empty();
}

std::string PartText(const ClipPart& part) {
  const std::string text = fmt::format("{:.1f} to {:.1f} (frames {} to {}", part.begin_s,
                                       part.end_s, part.first_frame, part.last_frame);
  if (!part.lacks.empty()) return fmt::format("{}: {})", text, part.lacks);
  return fmt::format("{}: {}{} markers)", text,
                     part.parallax_deg
                         ? fmt::format("{:.0f} degrees around the object, ", *part.parallax_deg)
                         : "",
                     part.num_markers);
}

void PrintParts(const std::vector<ClipPart>& parts, std::ostream& out) {
  std::vector<std::string> good, poor;
  for (const ClipPart& part : parts) {
    (part.lacks.empty() ? good : poor).push_back(PartText(part));
  }
  out << fmt::format("good_parts_s: {}\n",
                     good.empty() ? "none" : fmt::to_string(fmt::join(good, ", ")));
  if (!poor.empty()) out << fmt::format("poor_parts_s: {}\n", fmt::join(poor, ", "));
}

void PrintLight(const ClipFacts& facts, std::ostream& out) {
  if (!facts.white) return;
  out << fmt::format(
      "grey_levels: black {:.0f}, white {:.0f} of 255 (good: white at most {:.0f}, black at least "
      "{:.0f} below it)\n",
      *facts.black, *facts.white, kMaxWhite, kGoodContrast);
  out << fmt::format("blur_px: {:.2f} (1 sigma), motion {:.1f} during the exposure\n",
                     *facts.blur_px, *facts.motion_px);
}

void PrintPrecision(const ClipPrecision& precision, std::ostream& out) {
  out << fmt::format("precision: {:.2g} mm (1 sigma, median marker) from {} images, {} markers\n",
                     precision.marker_sigma_mm, precision.num_images, precision.num_markers);
  out << fmt::format("scale_sigma: {:.3f} %\n", 100 * precision.scale_sigma);
  out << fmt::format("parallax_deg: {:.0f}\n", precision.parallax_deg);
  if (const auto camera = FoundCameraNumber(precision.found_cameras)) {
    out << fmt::format("camera: {}\n", camera->value);
  }
}

void Print(const ClipFacts& facts, std::ostream& out) {
  PrintVerdict(JudgeClip(facts), out);
  if (const std::string hint = SizeHint(facts); !hint.empty()) {
    out << fmt::format("hint: {}\n", hint);
  }
  // A clip from one place, or with a zoom, looks as good as any other in each of its frames.
  if (facts.LacksSizes()) out << "not_checked: depth, zoom, stabilization\n";
  out << fmt::format("frames: {} of {} looked at, {} x {} px\n", facts.num_frames_read,
                     facts.num_frames, facts.width_px, facts.height_px);
  if (facts.dictionary.empty()) return;
  out << fmt::format(
      "dictionary: {}{}{}\n", facts.dictionary, facts.is_inverted ? ", inverted" : "",
      facts.num_markers_found
          ? fmt::format(
                " (found by trying: {} detections{})", *facts.num_markers_found,
                facts.num_markers_of_second
                    ? fmt::format("; {}: {}", facts.second_dictionary, *facts.num_markers_of_second)
                    : "; no other finds any, beyond chance")
          : "");
  out << fmt::format("markers_seen: {}\n", facts.num_frames_of_id.size());
  if (!facts.has_layout) {
    std::vector<int> ids;
    for (const auto& [marker_id, num_frames] : facts.num_frames_of_id) ids.push_back(marker_id);
    out << fmt::format("ids: {}\n", IdRanges(ids));
  } else {
    out << fmt::format("ids_never_seen: {}\n", IdRanges(facts.ids_never_seen));
    out << fmt::format("ids_not_in_layout: {}\n", IdRanges(facts.ids_not_in_layout));
  }
  if (!facts.ids_read_rarely.empty()) {
    out << fmt::format("ids_read_rarely: {} (probably misread: nothing to do)\n",
                       IdRanges(facts.ids_read_rarely));
  }
  if (facts.side_px.count > 0) {
    out << fmt::format("side_px: median {:.1f}, min {:.1f}, max {:.1f}\n", facts.side_px.median,
                       facts.side_px.min, facts.side_px.max);
  }
  PrintLight(facts, out);
  if (facts.precision) PrintPrecision(*facts.precision, out);
  if (facts.is_video) PrintParts(facts.parts, out);
}

// The dictionary file of the layout is named relative to the new file.
void WriteProposal(const LayoutProposal& proposal, const ClipCheckerCommandOptions& options) {
  const std::string& path = options.proposed_layout_path;
  Layout layout = proposal.layout;
  if (IsRegularFile(layout.dictionary)) {
    layout.dictionary = AbsolutePath(layout.dictionary)
                            .lexically_proximate(AbsolutePath(path).parent_path())
                            .string();
  }
  std::string comment = std::string(kProposedLayout) + "\n";
  if (!options.check.layout) {
    comment += fmt::format(
        "marker_length: NOT KNOWN, set to 0.1 m; give the length that the sheets name.\n{}\n",
        kLengthFromScale);
    comment +=
        "dictionary: found by trying, the smallest of its family with all ids that the clip shows; "
        "NOT SURE whether the print has more: then name the dictionary of the print.\n";
  }
  for (const std::string& note : proposal.notes) comment += note + "\n";
  WriteFileAtomically(
      path, [&](std::ostream& out) { out << WithSeal(LayoutText(layout, comment), "# ", ""); });
  std::cout << fmt::format("proposed_layout_path: {}\n", path);
}

void Run(const ClipCheckerCommandOptions& options) {
  const ClipCheck check = CheckClip(options.check);
  Print(check.facts, std::cout);
  if (check.proposal) WriteProposal(*check.proposal, options);
  const std::string& path = options.paths.output_path;
  if (path.empty()) return;
  WriteFileAtomically(path, [&](std::ostream& out) { out << EncodePng(check.marked_frame); });
  std::cout << fmt::format("frame_path: {} ({})\n", path, check.marked_frame_name);
}

}  // namespace

Command ClipChecker() { return MakeCommand<ClipCheckerCommandOptions>(Declare, Validate, Run); }

}  // namespace velamap
