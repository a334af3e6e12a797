#include "workflows/options/shared_options.h"

#include <array>
#include <filesystem>
#include <iostream>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "exporters/formats/shape_csv.h"
#include "importer/base/error.h"
#include "workflows/options/sail_options.h"
#include "workflows/run/logging.h"

namespace velamap {
namespace {

constexpr std::array<std::pair<FrameOrder, const char*>, 3> kFrameOrders = {
    {{FrameOrder::kAuto, "auto"},
     {FrameOrder::kTime, "time"},
     {FrameOrder::kUnordered, "unordered"}}};

FrameOrder FrameOrderFromName(const std::string& name) {
  for (const auto& [order, known_name] : kFrameOrders) {
    if (name == known_name) return order;
  }
  throw InputError(fmt::format(
      "--Registration.frame_order: '{}' is unknown; give auto, time or unordered", name));
}

constexpr std::array<std::pair<RegistrationMethod, const char*>, 2> kMethods = {
    {{RegistrationMethod::kThesis, "thesis"}, {RegistrationMethod::kGlobal, "global"}}};

RegistrationMethod MethodFromName(const std::string& name) {
  for (const auto& [method, known_name] : kMethods) {
    if (name == known_name) return method;
  }
  throw InputError(
      fmt::format("--Registration.method: '{}' is unknown; give thesis or global", name));
}

}  // namespace

Option ImagePathOption(PathOptions* paths) {
  return {"image_path", &paths->image_path, "path", "folder of images, or a video file", true};
}

Option CameraPathOption(PathOptions* paths) {
  return {"camera_path", &paths->camera_path, "path",
          "camera calibration: OpenCV YAML, XML or JSON, or a COLMAP cameras.txt", true};
}

Option PriorShapePathOption(PathOptions* paths) {
  return {"prior_shape_path", &paths->prior_shape_path, "path",
          "shape.csv of an earlier reconstruction of the surface, or the folder that holds it: "
          "markers are also looked for where it says that they should be visible"};
}

Option DatabasePathOption(PathOptions* paths, const std::string& description) {
  return {"database_path", &paths->database_path, "path", description, true};
}

Option ModelInputOption(PathOptions* paths) {
  return {"input_path", &paths->input_path, "path", "folder of the COLMAP model to read", true};
}

OptionGroup GeneralGroup(GeneralOptions* options) {
  return {"General",
          {{"log_level", &options->log_level, "level", "error, warn, info or debug"},
           {"random_seed", &options->random_seed, "seed", "same seed, same result"},
           {"num_threads", &options->num_threads, "count", "0: one a core"}}};
}

OptionGroup MarkerGroup(MarkerOptions* options, bool with_dictionary) {
  OptionGroup group{"Markers: a layout file, or the options that replace it",
                    {{"layout_path", &options->layout_path, "path",
                      "layout file (YAML): dictionary, sizes and places of the markers"},
                     {"marker_length", &options->marker_length_m, "m",
                      "outer edge of the black square; replaces the layout file"}}};
  if (with_dictionary) {
    group.options.push_back({"dictionary", &options->dictionary, "name|path",
                             "OpenCV dictionary name such as DICT_4X4_50, or dictionary file; "
                             "goes with --marker_length"});
  }
  return group;
}

OptionGroup ArucoDetectionGroup(ArucoDetectionOptions* options) {
  const ParsedValue refinement = {CornerRefinementName(options->corner_refinement),
                                  [options](const std::string& name) {
                                    options->corner_refinement = CornerRefinementFromName(name);
                                  }};
  const ParsedValue search = {SearchModeName(options->search), [options](const std::string& name) {
                                options->search = SearchModeFromName(name);
                              }};
  return {
      "Marker detection",
      {{"ArucoDetection.corner_refinement", refinement, "none|subpix|edge",
        "how corners get sub-pixel accuracy; subpix pulls them inwards"},
       {"ArucoDetection.min_marker_perimeter_rate", &options->min_marker_perimeter_rate, "fraction",
        "smallest marker perimeter, of the larger image side"},
       {"ArucoDetection.error_correction_rate", &options->error_correction_rate, "fraction",
        "part of the dictionary's error correction that is used"},
       {"ArucoDetection.inverted", &options->inverted, "0|1", "white markers on black ground"},
       {"ArucoDetection.search", search, "tracked|exhaustive",
        "of a video: around the markers of the frames before, or the whole of every frame; images "
        "are searched as a whole"},
       {"ArucoDetection.full_search_interval", &options->full_search_interval, "frames",
        "tracked: the whole of every k-th frame is searched"}}};
}

OptionGroup VideoGroup(VideoOptions* options) {
  return {"Video",
          {{"Video.first_frame", &options->first_frame, "frame", "first frame to read, from 0"},
           {"Video.last_frame", &options->last_frame, "frame", "last frame to read; -1: the end"},
           {"Video.frame_step", &options->frame_step, "frames", "read every k-th frame"}}};
}

OptionGroup RegistrationGroup(RegistrationOptions* options) {
  const ParsedValue method = {
      kMethods[static_cast<std::size_t>(options->method)].second,
      [options](const std::string& name) { options->method = MethodFromName(name); }};
  const ParsedValue order = {
      kFrameOrders[static_cast<std::size_t>(options->frame_order)].second,
      [options](const std::string& name) { options->frame_order = FrameOrderFromName(name); }};
  const ParsedValue central_frame = {
      "", [options](const std::string& name) { options->central_frame = name; }};
  return {
      "Registration of the frames",
      {{"Registration.method", method, "thesis|global",
        "thesis: rigid alignment around one central frame; global: resection against a growing "
        "map"},
       {"Registration.frame_order", order, "auto|time|unordered",
        "time: search around the central frame; unordered: grow from it; auto: time for a video"},
       {"Registration.central_frame", &options->central_frame, "name|frame",
        "image name or frame number; left out: the best one is chosen"},
       {"central_frame", central_frame, "name|frame", "the same, shorter"},
       {"Registration.max_num_frames", &options->global.max_num_frames, "frames",
        "most frames of a video that take part (global)"},
       {"Registration.num_starts", &options->global.num_starts, "count",
        "places from which the map is grown at most (global)"},
       {"Registration.num_frames", &options->thesis.num_frames, "frames",
        "frames on each side of the central one, 0: it alone (thesis, time order)"},
       {"Registration.skip", &options->thesis.skip, "frames",
        "steps between selected frames (thesis, time order)"},
       {"Registration.neighborhood", &options->thesis.neighborhood, "frames",
        "frames on each side of a step that compete (thesis, time order)"},
       {"Registration.ransac_max_error", &options->thesis.ransac_max_error_m, "m",
        "a marker further than this from its place is an outlier; 0: the marker's side"},
       {"Registration.min_num_inliers", &options->min_num_inliers, "markers",
        "fewest shared markers that have to agree"},
       {"Registration.frequency_threshold", &options->thesis.frequency_threshold, "fraction",
        "part of the registered frames that has to see a marker (thesis, time order)"},
       {"Registration.min_num_frames", &options->min_num_frames, "frames",
        "fewest frames that have to see a marker"},
       {"Registration.num_mean_iterations", &options->thesis.num_mean_iterations, "count",
        "iterations of the weighted mean"},
       {"Registration.mean_sigma", &options->thesis.mean_sigma_m, "m",
        "width of the mean's weights"}}};
}

OptionGroup BundleAdjustmentGroup(BundleAdjustmentOptions* options) {
  return {"Bundle adjustment",
          {{"colmap_path", &options->colmap_path, "path", "COLMAP's program"},
           {"BundleAdjustment.refine_focal_length", &options->refine_focal_length, "0|1",
            "adjust the focal length of the calibration"},
           {"BundleAdjustment.refine_principal_point", &options->refine_principal_point, "0|1",
            "adjust the principal point"},
           {"BundleAdjustment.refine_extra_params", &options->refine_extra_params, "0|1",
            "adjust the distortion"},
           {"BundleAdjustment.max_num_iterations", &options->max_num_iterations, "count",
            "iterations a round"},
           {"BundleAdjustment.function_tolerance", &options->function_tolerance, "fraction",
            "change of the cost that ends a round"},
           {"BundleAdjustment.max_num_rounds", &options->max_num_rounds, "count",
            "rounds of adjustment and removal of outliers"},
           {"BundleAdjustment.outlier_ratio", &options->outlier_ratio, "sigmas",
            "an error beyond so many robust sigmas is an outlier"},
           {"BundleAdjustment.min_outlier_error", &options->min_outlier_error_px, "px",
            "a smaller error is no outlier"},
           {"BundleAdjustment.min_track_length", &options->min_track_length, "images",
            "fewest images that have to see a corner"},
           {"BundleAdjustment.max_mean_error", &options->max_mean_error_px, "px",
            "a larger mean reprojection error is no result"}}};
}

OptionGroup MarkerAdjustmentGroup(MarkerAdjustmentOptions* options) {
  return {
      "Marker-aware adjustment (--backend markers or both)",
      {{"MarkerAdjustment.corner_sigma", &options->corner_sigma_px, "px",
        "1 sigma of a corner's coordinate where the detector gives none"},
       {"MarkerAdjustment.corner_sigma_floor", &options->corner_sigma_floor_px, "px",
        "added to every corner's own sigma, by squares"},
       {"MarkerAdjustment.loss", &options->loss_sigmas, "sigmas", "errors beyond this lose weight"},
       {"MarkerAdjustment.outlier", &options->outlier_sigmas, "sigmas",
        "corners beyond this are left out"},
       {"MarkerAdjustment.print_tolerance", &options->print_tolerance, "fraction",
        "1 sigma of each printed side"},
       {"MarkerAdjustment.common_print_tolerance", &options->common_print_tolerance, "fraction",
        "1 sigma of the print as a whole; widens the scale's sigma"},
       {"MarkerAdjustment.cloth_flatness", &options->cloth_flatness, "fraction",
        "1 sigma of a corner from its marker's plane, of the side; 0: unknown"},
       {"MarkerAdjustment.rigid_flatness", &options->rigid_flatness, "fraction",
        "the same on parts that the layout calls rigid"},
       {"MarkerAdjustment.inset_sigma", &options->inset_sigma_px, "px",
        "1 sigma of an error that all corners share, seen too far inside; widens the scale's "
        "sigma"},
       {"MarkerAdjustment.estimate_inset", &options->estimate_inset, "0|1",
        "estimate that error from the images"},
       {"MarkerAdjustment.intrinsics_sigma", &options->intrinsics_sigma, "fraction",
        "1 sigma of the calibration, where BundleAdjustment.refine_* frees it"},
       {"MarkerAdjustment.rolling_shutter", &options->rolling_shutter_s, "s",
        "time from the first row of a frame to the last; 0: not modelled"}}};
}

Option BackendOption(std::string* backend) {
  return {"backend", backend, "colmap|markers|both",
          "colmap: COLMAP's own program; markers: ours, which knows the markers' size and gives "
          "sigmas; both: one after the other"};
}

namespace {

// One project file may hold options for all commands.
std::set<std::string> SharedOptionNames() {
  GeneralOptions general;
  MarkerOptions markers;
  ArucoDetectionOptions detection;
  VideoOptions video;
  RegistrationOptions registration;
  BundleAdjustmentOptions adjustment;
  MarkerAdjustmentOptions marker_adjustment;
  ShapeExporterOptions exporter;
  SailOptionTexts sail;
  std::string backend;
  PathOptions paths;
  const OptionGroup path_group{
      "",
      {ImagePathOption(&paths), CameraPathOption(&paths), PriorShapePathOption(&paths),
       DatabasePathOption(&paths, ""), ModelInputOption(&paths), BackendOption(&backend)}};
  std::set<std::string> names;
  for (const OptionGroup& group :
       {GeneralGroup(&general), MarkerGroup(&markers, true), ArucoDetectionGroup(&detection),
        VideoGroup(&video), RegistrationGroup(&registration), BundleAdjustmentGroup(&adjustment),
        MarkerAdjustmentGroup(&marker_adjustment), SailGroup(&exporter, &sail), path_group}) {
    for (const Option& option : group.options) names.insert(option.name);
  }
  return names;
}

}  // namespace

bool ParseOrPrintHelp(const CommandSyntax& syntax, const std::vector<std::string>& arguments) {
  if (ParseOptions(syntax, arguments, SharedOptionNames())) return true;
  PrintHelp(syntax, std::cout);
  return false;
}

bool HasMarkerOptions(const MarkerOptions& options) {
  return !options.layout_path.empty() || options.marker_length_m.has_value();
}

Layout LoadLayout(const MarkerOptions& options, bool with_dictionary) {
  const bool has_length = options.marker_length_m.has_value();
  if (!options.layout_path.empty()) {
    if (has_length || !options.dictionary.empty()) {
      throw InputError(
          "--layout_path: the layout file gives dictionary and length; leave out "
          "--dictionary and --marker_length");
    }
    return ReadLayout(options.layout_path);
  }
  if (!has_length || (with_dictionary && options.dictionary.empty())) {
    throw InputError(fmt::format("--layout_path: missing; give a layout file, or --marker_length{}",
                                 with_dictionary ? " and --dictionary" : ""));
  }
  CheckMarkerLength(*options.marker_length_m, "--marker_length");
  return MakeLayout(options.dictionary, *options.marker_length_m);
}

std::string ShapeFile(const std::string& path) {
  const std::filesystem::path file = path;
  return std::filesystem::is_directory(file) ? (file / "shape.csv").string() : path;
}

PriorShape LoadPriorShape(const std::string& prior_shape_path) {
  PriorShape prior_shape;
  if (prior_shape_path.empty()) return prior_shape;
  const std::string file = ShapeFile(prior_shape_path);
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(
        fmt::format("--prior_shape_path: {}: there is no such file; give a shape.csv or the folder "
                    "that holds it, such "
                    "as shape in a workspace",
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

void ApplyGeneralOptions(const GeneralOptions& options) {
  SetLogLevel(options.log_level);
  if (options.num_threads < 0 || options.num_threads > 1024) {
    throw InputError(fmt::format("--num_threads: {} is out of range; give 0 (one a core) to 1024",
                                 options.num_threads));
  }
  if (options.random_seed < 0) {
    throw InputError(
        fmt::format("--random_seed: {} is negative; give 0 or more", options.random_seed));
  }
}

}  // namespace velamap
