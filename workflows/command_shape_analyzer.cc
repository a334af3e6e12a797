#include <filesystem>
#include <iostream>

#include "exporters/metrics_text.h"
#include "exporters/part_planes.h"
#include "exporters/shape_csv.h"
#include "exporters/shape_metrics.h"
#include "importer/error.h"
#include "workflows/commands.h"
#include "workflows/shared_options.h"

namespace velamap {
namespace {

struct Options {
  PathOptions paths;
  MarkerOptions markers;
  GeneralOptions general;
  bool part_planes = false;
};

CommandSyntax Declare(Options* options) {
  PathOptions* paths = &options->paths;
  return {"shape_analyzer",
          "judges a shape by the printed size of its markers and against a reference",
          "--shape_path shape/shape.csv --layout_path layout.yml --reference_path truth.csv",
          {{"Input and output",
            {{"shape_path", &paths->shape_path, "path", "shape.csv, or the folder that holds it",
              true},
             {"reference_path", &paths->reference_path, "path",
              "shape.csv of the truth or the design; the shape is aligned with it"},
             {"part_planes", &options->part_planes, "0|1",
              "fit a plane to every part and compare the planes"}}},
           MarkerGroup(&options->markers, false),
           GeneralGroup(&options->general)}};
}

void Validate(const Options& options) {
  ApplyGeneralOptions(options.general);
  if (!HasMarkerOptions(options.markers) && options.paths.reference_path.empty() &&
      !options.part_planes) {
    throw InputError(
        "--layout_path: missing; give it or --marker_length to judge the markers' size, "
        "--reference_path to compare, or --part_planes 1");
  }
}

std::string ShapeFile(const std::string& path) {
  const std::filesystem::path file = path;
  return std::filesystem::is_directory(file) ? (file / "shape.csv").string() : path;
}

}  // namespace

void RunShapeAnalyzer(const Arguments& arguments) {
  Options options;
  const CommandSyntax syntax = Declare(&options);
  if (!ParseOptions(syntax, arguments, SharedOptionNames())) {
    PrintHelp(syntax, std::cout);
    return;
  }
  Validate(options);
  const MarkerShape shape = ReadShapeCsv(ShapeFile(options.paths.shape_path));
  if (HasMarkerOptions(options.markers)) {
    PrintMetrics(ComputeShapeMetrics(shape, LoadLayout(options.markers, false)), std::cout);
  }
  if (options.part_planes) PrintPlanes(FitPartPlanes(shape), std::cout);
  if (!options.paths.reference_path.empty()) {
    PrintMetrics(CompareShapes(shape, ReadShapeCsv(ShapeFile(options.paths.reference_path))),
                 std::cout);
  }
}

}  // namespace velamap
