// Options that several commands share, and readers of the files that they name.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "exporters/scale/metric_scale.h"
#include "importer/base/log.h"
#include "importer/camera/camera.h"
#include "importer/layout/layout.h"
#include "importer/layout/prior_shape.h"
#include "importer/marker_importer.h"
#include "reconstruct/registration/registration_options.h"
#include "workflows/options/option_parser.h"
#include "workflows/options/preset.h"
#include "workflows/run/adjustment.h"

namespace velamap {

struct GeneralOptions {
  LogLevel log_level = LogLevel::kInfo;
  int random_seed = 0;
  int num_threads = 0;  // 0: one per core
};

// Files and folders; each command declares those that it reads or writes.
struct PathOptions {
  std::string image_path;
  std::string camera_path;
  std::string prior_shape_path;
  std::string database_path;
  std::string workspace_path;
  std::string input_path;
  std::string output_path;
  std::string shape_path;
  std::string reference_path;
  std::string registration_path;
  std::string log_path;
};

// What the markers are: a layout file, or the options that replace it.
struct MarkerOptions {
  std::string layout_path;
  std::string dictionary;
  std::optional<double> marker_length_m;
};

// What most commands have; the options of a command derive from it.
struct CommandOptions {
  PathOptions paths;
  MarkerOptions markers;
  GeneralOptions general;
  Preset preset;
  TypedNames typed;
  std::vector<std::string> arguments;  // as they were typed
};

Option Required(Option option);

Option ImagePathOption(PathOptions* paths);
Option CameraPathOption(PathOptions* paths);
Option PriorShapePathOption(PathOptions* paths);
Option DatabaseInputOption(PathOptions* paths);
Option ImportAnewOption(MarkerImporterOptions* importer);
Option ModelInputOption(PathOptions* paths);
Option ShapeInputOption(PathOptions* paths);
Option ColmapLogOption(PathOptions* paths);
Option BackendOption(AdjustmentBackend* backend);
Option ScaleOption(ScaleMethod* scale_by);

OptionGroup DescribeOptions(GeneralOptions* options);
// A command that detects nothing has no use for a dictionary.
OptionGroup DescribeOptions(MarkerOptions* options, bool with_dictionary);

// Whether any option says what the markers are.
bool HasMarkerOptions(const MarkerOptions& options);

// Returns nothing without a path. Throws InputError as ReadCalibration() does.
std::optional<Camera> LoadCalibration(const PathOptions& paths);

// Throws InputError unless a layout file alone, or a marker length (with a dictionary, where one is
// needed) is given, and where ReadLayout() does.
Layout LoadLayout(const MarkerOptions& options, bool with_dictionary);

// The same; nothing if no option says what the markers are.
std::optional<Layout> LoadGivenLayout(const MarkerOptions& options, bool with_dictionary);

// `path`, or the shape.csv in it if it is a folder.
std::string ShapeFile(const std::string& path);

// sparse/0 beside the folder that holds the ShapeFile(): where a workspace has the model of a
// shape.
std::filesystem::path ModelFolderOfShape(const std::string& path);

// Reads the whole markers of an earlier shape; none for an empty path. Throws InputError for a file
// that is not a shape.csv or has no whole marker.
PriorShape LoadPriorShape(const std::string& prior_shape_path);

// Called once the options are set: completes the options of a stage from the command's options and
// the files that they name, and checks them. Throws InputError if a file or a value is bad.
void CompleteImporter(const CommandOptions& options, MarkerImporterOptions* importer);
void CompleteRegistration(const GeneralOptions& options, RegistrationOptions* registration);

}  // namespace velamap
