// Options that several commands share, each declared in this one place.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/detect/detection_options.h"
#include "importer/layout/layout.h"
#include "importer/layout/prior_shape.h"
#include "importer/video/video_options.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/registration/registration_options.h"
#include "workflows/options/option_parser.h"

namespace velamap {

struct GeneralOptions {
  std::string log_level = "info";
  int random_seed = 0;
  int num_threads = 0;  // 0: one a core
};

// Files and folders; each command declares those that it reads or writes.
struct PathOptions {
  std::string image_path;
  std::string camera_path;
  std::string prior_shape_path;
  std::string database_path;
  std::string frame_output_path;
  std::string workspace_path;
  std::string input_path;
  std::string output_path;
  std::string shape_path;
  std::string reference_path;
  std::string registration_path;
  std::string log_path;
};

// What is known of the markers: a layout file, or the options that replace it.
struct MarkerOptions {
  std::string layout_path;
  std::string dictionary;
  std::optional<double> marker_length_m;
};

Option ImagePathOption(PathOptions* paths);
Option CameraPathOption(PathOptions* paths);
Option PriorShapePathOption(PathOptions* paths);
Option DatabasePathOption(PathOptions* paths, const std::string& description);
Option ModelInputOption(PathOptions* paths);

OptionGroup GeneralGroup(GeneralOptions* options);
// Without detection the dictionary does not matter.
OptionGroup MarkerGroup(MarkerOptions* options, bool with_dictionary);
OptionGroup ArucoDetectionGroup(ArucoDetectionOptions* options);
OptionGroup VideoGroup(VideoOptions* options);
OptionGroup RegistrationGroup(RegistrationOptions* options);
OptionGroup BundleAdjustmentGroup(BundleAdjustmentOptions* options);
OptionGroup MarkerAdjustmentGroup(MarkerAdjustmentOptions* options);
Option BackendOption(std::string* backend);

// Sets the options that the arguments give. With --help it prints the help on stdout and returns
// false: the command has nothing more to do. Throws InputError as ParseOptions() does.
bool ParseOrPrintHelp(const CommandSyntax& syntax, const std::vector<std::string>& arguments);

// Whether anything says how large the markers are.
bool HasMarkerOptions(const MarkerOptions& options);

// Throws InputError unless a layout file alone, or a marker length (with a dictionary, where one is
// needed) is given, and for what ReadLayout() refuses.
Layout LoadLayout(const MarkerOptions& options, bool with_dictionary);

// `path`, or the shape.csv in it if it is a folder.
std::string ShapeFile(const std::string& path);

// The whole markers of an earlier shape; none for an empty path. Throws InputError for a file that
// is no shape.csv or has no whole marker.
PriorShape LoadPriorShape(const std::string& prior_shape_path);

// Sets the log level and the bounds that more than one library relies on. Throws InputError.
void ApplyGeneralOptions(const GeneralOptions& options);

}  // namespace velamap
