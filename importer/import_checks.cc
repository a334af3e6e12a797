#include "importer/import_checks.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/base/log.h"
#include "importer/base/option.h"
#include "importer/base/replacement.h"
#include "importer/database/source_table.h"
#include "importer/frame_camera.h"
#include "importer/track/frame_detector.h"
#include "importer/video/frame_source.h"
#include "importer/video/source_file.h"
#include "importer/video/written_frame.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;

// Another dictionary or polarity has to find this many times as many markers per frame to be
// suggested.
constexpr double kConvincingRatio = 10.0;

void CheckVideo(const MarkerImporterOptions& options,
                const std::map<std::string, SourceFile>& sources) {
  const auto known = sources.find(kVideoSource);
  if (known == sources.end() || HasSameContent(known->second, options.image_path)) return;
  throw InputError(fmt::format("{}: was made from {} ({}); {}", options.database_path,
                               IsSamePlace(known->second, options.image_path)
                                   ? "the video before it was changed"
                                   : "another video than " + options.image_path,
                               SourceText(known->second), kImportAnewRemedy));
}

// Throws InputError if the database holds frames that the options do not select now, because these
// would still be in the result.
void CheckFrames(const MarkerImporterOptions& options,
                 const std::vector<std::string>& known_names) {
  const auto is_left_out = [&](const std::string& name) {
    const std::optional<int> number = NumberOfVideoFrame(name);
    return number && !options.allowed_frames.Selects(*number);
  };
  const auto first = std::find_if(known_names.begin(), known_names.end(), is_left_out);
  if (first == known_names.end()) return;
  throw InputError(fmt::format(
      "{}: holds {} frames, such as {}, that {}, {} and {} leave out; {}", options.database_path,
      std::count_if(first, known_names.end(), is_left_out), *first,
      OptionName(&VideoOptions::first_frame), OptionName(&VideoOptions::last_frame),
      OptionName(&VideoOptions::frame_step), kImportAnewRemedy));
}

void CheckPhotograph(const MarkerImporterOptions& options, const std::string& name,
                     const SourceFile& known) {
  const fs::path file = fs::path(options.image_path) / name;
  if (IsRegularFile(file)) {
    if (HasSameContent(known, file.string())) return;
    if (!options.is_only_source && !IsSamePlace(known, file)) {
      throw InputError(fmt::format(
          "{}: holds another picture of the name {} ({}); rename the pictures, or put both folders "
          "into one and import that into a new database",
          options.database_path, name, SourceText(known)));
    }
    throw InputError(fmt::format("{}: {} has changed since it was imported (it was {}); {}",
                                 options.database_path, file.string(), SourceText(known),
                                 kImportAnewRemedy));
  }
  // Photographs of several folders may share a database outside a workspace.
  if (!options.is_only_source && !IsSamePlace(known, file)) return;
  throw InputError(fmt::format("{}: holds {}, which is not in {} (it was {}); {}",
                               options.database_path, name, options.image_path, SourceText(known),
                               kImportAnewRemedy));
}

void CheckPhotographs(const MarkerImporterOptions& options,
                      const std::map<std::string, SourceFile>& sources) {
  for (const auto& [name, source] : sources) {
    if (name != kVideoSource) {
      CheckPhotograph(options, name, source);
    } else if (options.is_only_source) {
      throw InputError(fmt::format("{}: was made from a video ({}), not from photographs; {}",
                                   options.database_path, SourceText(source), kImportAnewRemedy));
    }
  }
}

// Throws DataError that says why all markers that were found are rejected.
[[noreturn]] void ThrowAllRejected(const MarkerImporterOptions& options,
                                   const ImportReport& report) {
  const int num_foreign = report.num_not_in_layout, num_doubtful = report.num_doubtful_rotations;
  const int num_duplicates = report.num_rejected - num_foreign - num_doubtful;
  if (num_foreign == report.num_rejected) {
    throw DataError(
        fmt::format("{}: no marker of the layout found, only other ids: {}; check the "
                    "layout's dictionary and markers",
                    options.image_path, fmt::join(report.ids_not_in_layout, " ")));
  }
  std::vector<std::string> reasons;
  if (num_duplicates > 0) {
    reasons.push_back(fmt::format(
        "{} because their id occurs more than once in a picture ({})", num_duplicates,
        options.layout.parts.empty()
            ? "give a layout, --layout_path, that tells the markers apart"
            : "show their neighbours in the layout, which tell them apart, in the same picture"));
  }
  if (num_doubtful > 0) {
    reasons.push_back(
        fmt::format("{} because their code looks the same when turned (show markers beside them "
                    "whose codes do not, or print others)",
                    num_doubtful));
  }
  if (num_foreign > 0) {
    reasons.push_back(fmt::format("{} because the layout does not name their ids: {}", num_foreign,
                                  fmt::join(report.ids_not_in_layout, " ")));
  }
  throw DataError(fmt::format("{}: none of the markers that were found can be used: {}",
                              options.image_path, fmt::join(reasons, ", ")));
}

}  // namespace

void CheckSameSettings(const MarkerImporterOptions& options, const std::string& detector,
                       const ColmapDatabase& database) {
  const std::optional<std::string> known_detector = database.ReadDetector();
  if (!known_detector) return;  // it holds no images
  if (*known_detector != detector) {
    throw InputError(
        fmt::format("{}: was made with other detection options, another layout or "
                    "another prior shape ({}; this run has {}); {}",
                    options.database_path, SettingsThatDiffer(*known_detector, detector),
                    SettingsThatDiffer(detector, *known_detector), kImportAnewRemedy));
  }
  if (!options.camera && database.HasCalibration() && !database.ReadCameras().empty()) {
    throw InputError(
        fmt::format("{}: was made with a calibration (--camera_path); give it again, {}",
                    options.database_path, kImportAnewRemedy));
  }
  if (!options.camera) return;
  if (!database.HasCalibration()) {
    throw InputError(fmt::format("{}: was made without the calibration {}; {}",
                                 options.database_path, options.camera_path, kImportAnewRemedy));
  }
  for (const auto& [camera_id, camera] : database.ReadCameras()) {
    if (!IsSameCalibration(options, camera)) {
      throw InputError(fmt::format("{}: was made with a calibration other than {}; {}",
                                   options.database_path, options.camera_path, kImportAnewRemedy));
    }
  }
}

void CheckSources(const MarkerImporterOptions& options, const std::vector<std::string>& known_names,
                  const ColmapDatabase& database) {
  const std::map<std::string, SourceFile> sources = database.ReadSources();
  if (IsFolder(options.image_path)) return CheckPhotographs(options, sources);
  const auto photograph = sources.upper_bound(kVideoSource);
  if (options.is_only_source && photograph != sources.end()) {
    throw InputError(fmt::format("{}: was made from photographs ({}), not from a video; {}",
                                 options.database_path, SourceText(photograph->second),
                                 kImportAnewRemedy));
  }
  CheckVideo(options, sources);
  if (options.is_only_source) CheckFrames(options, known_names);
}

void RecordSources(const MarkerImporterOptions& options,
                   const std::vector<std::string>& known_names, ColmapDatabase* database) {
  if (known_names.empty() || !database->ReadSources().empty()) return;
  LogWarning(
      "{}: made by an earlier velamap, which did not record its source; assuming it is from {}",
      options.database_path, options.image_path);
  for (const std::string& name : known_names) {
    const fs::path file = fs::path(options.image_path) / name;
    if (IsRegularFile(file)) database->WriteSource(name, IdentifySource(file.string()));
  }
  if (IsRegularFile(options.image_path)) {
    database->WriteSource(kVideoSource, IdentifySource(options.image_path));
  }
}

void CheckFrameFolder(const MarkerImporterOptions& options,
                      const std::vector<std::string>& known_names) {
  const std::string& folder = options.frame_output_path;
  if (folder.empty() || IsFolder(options.image_path) || !IsFolder(folder)) return;
  RemoveUnfinished(folder);
  const std::set<std::string> known(known_names.begin(), known_names.end());
  for (const fs::path& file : FolderEntries(folder)) {
    const std::string name = file.filename().string();
    if (!NumberOfVideoFrame(name) || known.count(name) > 0 || IsWrittenFrame(file)) continue;
    throw InputError(
        fmt::format("{}: a picture that velamap did not write is where a frame would go; move "
                    "it away, or choose another folder",
                    file.string()));
  }
}

void CheckPixelAspect(const MarkerImporterOptions& options) {
  constexpr double kTolerance = 0.01;  // rounded ratios such as 4320:4319 mean square pixels
  if (options.camera) return;
  const double pixel_aspect = PixelAspect(options.image_path);
  if (std::abs(pixel_aspect - 1) < kTolerance) return;
  throw InputError(fmt::format(
      "{}: its pixels are {:.3f} times as wide as high, and without a calibration from such "
      "pictures they are taken to be square; make them square with ffmpeg -i VIDEO -vf "
      "scale=iw*sar:ih,setsar=1 -crf 12 square.mp4",
      options.image_path, pixel_aspect));
}

void CheckCalibrationSize(const MarkerImporterOptions& options) {
  if (!options.camera) return;
  const std::unique_ptr<FrameSource> source =
      OpenFrameSource(options.image_path, options.video, {}, options.num_threads);
  while (std::optional<Frame> frame = source->Next()) {
    std::string reason;
    if (!source->Load(&*frame, &reason)) continue;
    CameraOfFrame(options, source->IsVideo(), *frame);
    return;
  }
}

void CheckMarkersFound(const MarkerImporterOptions& options, const std::string& dictionary_name,
                       const ImageSample& sample, const ImportReport& report) {
  if (options.chessboard) {
    if (report.num_markers > 0) return;
    throw DataError(fmt::format(
        "{}: no {} is seen in {} pictures: count the corners where four squares meet, and show the "
        "whole board, with its white margin, in even light",
        options.image_path, ChessboardName(*options.chessboard), report.num_frames_read));
  }
  const std::vector<DictionaryHint> hints =
      SuggestDictionaries(sample.Images(), options.layout.border_bits, options.detection);
  const int num_found = report.num_markers + report.num_rejected;
  const double rate = static_cast<double>(num_found) / std::max(report.num_frames_read, 1);
  const bool is_convincing =
      !hints.empty() && static_cast<double>(hints.front().num_markers) >=
                            kConvincingRatio * rate * hints.front().num_images;
  const std::string wanted = dictionary_name + (options.detection.inverted ? " (inverted)" : "");
  if (is_convincing) {
    throw DataError(fmt::format("{}: {} marker of {} found in {} frames; found with {}",
                                options.image_path, num_found > 0 ? "hardly any" : "no", wanted,
                                report.num_frames_read, DescribeHints(hints)));
  }
  if (report.num_markers > 0) return;
  if (report.num_rejected > 0) ThrowAllRejected(options, report);
  throw DataError(fmt::format(
      "{}: no marker of {} found in {} frames; no predefined dictionary finds more: check focus, "
      "size and border of the markers",
      options.image_path, wanted, report.num_frames_read));
}

}  // namespace velamap
