#include "workflows/options/shared_options.h"

#include <filesystem>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "exporters/formats/shape_csv.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/camera/calibration.h"
#include "importer/layout/dictionary.h"

namespace velamap {
namespace {

// Takes "warning", too, which the messages begin with.
Option LogLevelOption(LogLevel* level) {
  Option option = ChoiceOption("log_level", level,
                               {{LogLevel::kError, "error"},
                                {LogLevel::kWarn, "warn"},
                                {LogLevel::kInfo, "info"},
                                {LogLevel::kDebug, "debug"}},
                               "least severe messages that are shown");
  auto& parsed = std::get<ParsedValue>(option.target);
  parsed.set = [set = parsed.set](const std::string& text, const std::string& name) {
    set(text == "warning" ? "warn" : text, name);
  };
  return option;
}

// The error of a name that is no dictionary does not name the layout that holds it.
void CheckDictionary(const Layout& layout, const std::string& layout_path) {
  try {
    LoadDictionary(layout.dictionary);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: key 'dictionary': {}", layout_path, error.what()));
  }
}

}  // namespace

Option Required(Option option) {
  option.required = true;
  return option;
}

Option ImagePathOption(PathOptions* paths) {
  return Required(PathOption("image_path", PathUse::kReadsPictures, &paths->image_path,
                             "folder of images, or a video file"));
}

Option CameraPathOption(PathOptions* paths) {
  return Common(
      PathOption("camera_path", PathUse::kReadsFile, &paths->camera_path,
                 "camera calibration: OpenCV YAML, XML or JSON, or a COLMAP cameras.txt; left "
                 "out: the camera is found from the pictures"));
}

Option PriorShapePathOption(PathOptions* paths) {
  Option option =
      PathOption("prior_shape_path", PathUse::kReadsShape, &paths->prior_shape_path,
                 "shape.csv of an earlier reconstruction of the surface, or its folder: markers "
                 "are also searched where it says that they should be visible");
  option.old_names = {"map_path"};
  return option;
}

std::optional<Camera> LoadCalibration(const PathOptions& paths) {
  if (paths.camera_path.empty()) return std::nullopt;
  return ReadCalibration(paths.camera_path);
}

Option DatabaseInputOption(PathOptions* paths) {
  return Required(PathOption("database_path", PathUse::kReadsFile, &paths->database_path,
                             "COLMAP database that marker_importer made"));
}

Option ImportAnewOption(MarkerImporterOptions* importer) {
  return {"import_anew", &importer->import_anew, "0|1",
          "1: import all pictures again, for example because they have changed, and replace the "
          "detections in the database"};
}

Option ModelInputOption(PathOptions* paths) {
  return Required(PathOption("input_path", PathUse::kReadsModel, &paths->input_path,
                             "folder of the COLMAP model to read"));
}

Option ShapeInputOption(PathOptions* paths) {
  return Required(PathOption("shape_path", PathUse::kReadsShape, &paths->shape_path,
                             "shape.csv, or the folder that holds it"));
}

Option ColmapLogOption(PathOptions* paths) {
  return BesideIfLeftOut(PathOption("log_path", PathUse::kWritesFile, &paths->log_path,
                                    "COLMAP's output; left out: colmap.log beside output_path"),
                         &paths->output_path, "colmap.log");
}

Option BackendOption(AdjustmentBackend* backend) {
  return Common(
      ChoiceOption("backend", backend,
                   {{AdjustmentBackend::kColmap, "colmap"},
                    {AdjustmentBackend::kMarkers, "markers"},
                    {AdjustmentBackend::kBoth, "both"}},
                   "colmap: COLMAP's bundle adjuster; markers: velamap's marker-aware adjustment, "
                   "which uses the markers' size and gives sigmas; both: COLMAP's, then velamap's",
                   {{AdjustmentBackend::kMarkers, "ceres"}}));
}

Option ScaleOption(ScaleMethod* scale_by) {
  return ChoiceOption(
      "scale_by", scale_by,
      {{ScaleMethod::kAgreeing, "agreeing_markers"}, {ScaleMethod::kMeanSide, "mean_side"}},
      "how the metric scale is computed after COLMAP's adjustment: from the mean over the markers "
      "that agree, or from the mean side of all; the marker-aware adjustment needs no scale");
}

OptionGroup DescribeOptions(GeneralOptions* options) {
  return {
      "General",
      {LogLevelOption(&options->log_level),
       {"random_seed", &options->random_seed, "seed",
        "seed of the random numbers; the same seed gives the same result", AtLeast(0)},
       {"num_threads", &options->num_threads, "count",
        "number of threads; 0: one per core; the result does not depend on it", FromTo(0, 1024)}}};
}

OptionGroup DescribeOptions(MarkerOptions* options, bool with_dictionary) {
  OptionGroup group{
      "Markers: a layout file, or the options that replace it",
      {Common(PathOption("layout_path", PathUse::kReadsLayout, &options->layout_path,
                         "layout file (YAML): dictionary, sizes and places of the markers")),
       Common({"marker_length", &options->marker_length_m, "m",
               "outer edge of the black square; replaces the layout file",
               FromTo(kMinMarkerLength_m, kMaxMarkerLength_m)})}};
  if (with_dictionary) {
    group.options.push_back(
        Common({"dictionary", &options->dictionary, "name|path",
                "OpenCV dictionary name such as DICT_4X4_50, or dictionary file; used with "
                "--marker_length"}));
    group.options.back().path_use = PathUse::kReadsFile;
  }
  return group;
}

bool HasMarkerOptions(const MarkerOptions& options) {
  return !options.layout_path.empty() || options.marker_length_m.has_value() ||
         !options.dictionary.empty();
}

Layout LoadLayout(const MarkerOptions& options, bool with_dictionary) {
  const bool has_length = options.marker_length_m.has_value();
  if (!options.layout_path.empty()) {
    if (has_length || !options.dictionary.empty()) {
      throw InputError(fmt::format(
          "--layout_path: the layout file says what the markers are; leave out {}--marker_length",
          with_dictionary ? "--dictionary and " : ""));
    }
    Layout layout = ReadLayout(options.layout_path);
    if (with_dictionary) CheckDictionary(layout, options.layout_path);
    return layout;
  }
  if (has_length && with_dictionary && options.dictionary.empty()) {
    throw InputError(
        "--dictionary: missing; give that of the markers, such as DICT_4X4_50, beside "
        "--marker_length, or a layout file by --layout_path instead of both");
  }
  if (!has_length) {
    throw InputError(
        fmt::format("--layout_path: missing; give a layout file, or --marker_length{}",
                    with_dictionary && options.dictionary.empty() ? " and --dictionary" : ""));
  }
  return MakeLayout(options.dictionary, *options.marker_length_m);
}

std::optional<Layout> LoadGivenLayout(const MarkerOptions& options, bool with_dictionary) {
  if (!HasMarkerOptions(options)) return std::nullopt;
  return LoadLayout(options, with_dictionary);
}

std::string ShapeFile(const std::string& path) {
  const std::filesystem::path file = path;
  return IsFolder(file) ? (file / "shape.csv").string() : path;
}

std::filesystem::path ModelFolderOfShape(const std::string& path) {
  return AbsolutePath(ShapeFile(path)).parent_path().parent_path() / "sparse" / "0";
}

PriorShape LoadPriorShape(const std::string& prior_shape_path) {
  PriorShape prior_shape;
  if (prior_shape_path.empty()) return prior_shape;
  const std::string file = ShapeFile(prior_shape_path);
  if (!IsRegularFile(file)) {
    throw InputError(
        fmt::format("--prior_shape_path: {}: there is no such file; give a shape.csv or the folder "
                    "that holds it, such as shape in a workspace",
                    file));
  }
  for (const ShapeMarker& marker : ReadShapeCsv(file).markers) {
    if (!marker.IsWhole()) continue;
    const auto& x = marker.x_in_shape_m;
    prior_shape[marker.marker_id] = {*x[1], *x[2], *x[3], *x[4]};
  }
  if (prior_shape.empty()) {
    throw InputError(
        fmt::format("--prior_shape_path: {}: no marker has all four corners; give the shape.csv of "
                    "a whole result",
                    file));
  }
  return prior_shape;
}

void CompleteImporter(const CommandOptions& options, MarkerImporterOptions* importer) {
  importer->detection.Check();
  importer->video.Check();
  importer->layout = LoadLayout(options.markers, true);
  importer->camera = LoadCalibration(options.paths);
  importer->camera_path = options.paths.camera_path;
  importer->prior_shape = LoadPriorShape(options.paths.prior_shape_path);
  importer->image_path = options.paths.image_path;
  importer->num_threads = options.general.num_threads;
}

void CompleteRegistration(const GeneralOptions& options, RegistrationOptions* registration) {
  registration->random_seed = options.random_seed;
  registration->num_threads = options.num_threads;
  registration->Check();
}

}  // namespace velamap
