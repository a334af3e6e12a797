#include <filesystem>
#include <iostream>
#include <optional>

#include <fmt/format.h>

#include "exporters/formats/shape_csv.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "importer/layout/dictionary.h"
#include "importer/print/drawing_writer.h"
#include "importer/print/placement.h"
#include "importer/print/print_options.h"
#include "importer/print/sheet_plan.h"
#include "workflows/commands/commands.h"
#include "workflows/commands/compared_shapes.h"
#include "workflows/options/option_effects.h"
#include "workflows/options/shared_options.h"
#include "workflows/plan/plan_drawing.h"
#include "workflows/plan/plan_writer.h"
#include "workflows/run/progress.h"

namespace velamap {
namespace {

struct ShootPlannerCommandOptions : CommandOptions {
  Arrangement arrangement = Arrangement::kSail;
  SailPlacementOptions sail;
  GridPlacementOptions grid;
  ShootPlanOptions plan;
  Layout layout;
};

CommandSyntax Declare(ShootPlannerCommandOptions* options) {
  PathOptions* paths = &options->paths;
  return {
      "shoot_planner",
      "plans a shoot: predicts distance, shutter, path and the sigmas of the markers",
      "--field_of_view 90 --lens wide --width 3840 --height 2160 --marker_length 0.1 \\\n"
      "    --Sail.luff 6 --Sail.foot 3 --Sail.leech 6.2 --Plan.speed_knots 3 "
      "--output_path plan",
      {{"Input and output",
        {Common(
             PathOption("camera_path", PathUse::kReadsFile, &paths->camera_path,
                        "camera calibration: OpenCV YAML, XML or JSON, or a COLMAP cameras.txt")),
         Common(PathOption("shape_path", PathUse::kReadsShape, &paths->shape_path,
                           "shape.csv, or its folder, of an earlier result or a design: where the "
                           "markers are, instead of --Plan.surface")),
         Common(PathOption("output_path", PathUse::kWritesFolder, &paths->output_path,
                           "folder for plan.csv, markers.csv and plan.svg; new, empty, or as an "
                           "earlier run left it; left out: none")),
         ChoiceOption("Plan.surface", &options->arrangement,
                      {{Arrangement::kSail, "sail"}, {Arrangement::kGrid, "grid"}},
                      "what the markers are on, placed as marker_generator places them")}},
       DescribeOptions(&options->markers, true),
       DescribeOptions(&options->plan),
       DescribeOptions(&options->sail),
       DescribeOptions(&options->grid),
       DescribeOptions(&options->general)}};
}

void RefuseUnusedOptions(const ShootPlannerCommandOptions& options) {
  if (!options.paths.camera_path.empty()) {
    RefuseOptionsWithoutEffect(options.typed, {"lens", "width", "height"},
                               "the calibration of --camera_path says what the camera is");
  }
  if (!options.paths.shape_path.empty()) {
    RefuseOptionsWithoutEffect(
        options.typed,
        {"Plan.surface", "Sail.", "Grid.", "hull_markers", "Plan.camber", "Plan.twist"},
        "the markers are where --shape_path has them");
  } else if (options.arrangement == Arrangement::kSail) {
    RefuseOptionsWithoutEffect(options.typed, {"Grid."}, "--Plan.surface is sail");
  } else {
    RefuseOptionsWithoutEffect(options.typed, {"Sail.", "Plan.camber", "Plan.twist"},
                               "--Plan.surface is grid");
  }
}

// Called once the layout is read.
void RefuseOptionsOfPlacement(const ShootPlannerCommandOptions& options) {
  if (!options.paths.shape_path.empty() || !options.layout.HasMarkers()) return;
  RefuseOptionsWithoutEffect(options.typed, {"hull_markers", "Sail.lines", "Sail.markers_per_line"},
                             "the layout says which markers there are");
}

void CheckCamera(const ShootPlannerCommandOptions& options) {
  if (options.paths.camera_path.empty() || !options.plan.field_of_view_deg) return;
  throw InputError(
      "--field_of_view: the calibration says it already; leave out this option or --camera_path");
}

void Validate(ShootPlannerCommandOptions* options) {
  options->plan.seed = static_cast<std::uint32_t>(options->general.random_seed);
  options->plan.num_threads = options->general.num_threads;
  options->plan.Check();
  options->sail.Check();
  options->grid.Check();
  CheckCamera(*options);
  RefuseUnusedOptions(*options);
  if (options->markers.layout_path.empty() && options->markers.dictionary.empty()) {
    options->markers.dictionary = kDefaultDictionary;
  }
  options->layout = LoadLayout(options->markers, true);
  RefuseOptionsOfPlacement(*options);
}

// Places the markers of the options as marker_generator does, or those of the layout's lines.
PlannedSurface PlaceMarkers(const ShootPlannerCommandOptions& options) {
  Layout layout = options.layout;
  const double length_mm = kMmPerM * layout.marker_length_m;
  const int num_cells = CellsPerSide(LoadDictionary(layout.dictionary), layout.border_bits);
  const double sticker_mm = MakeSticker({0, length_mm, ""}, num_cells, {}).Height();
  Placement placement;
  if (layout.HasMarkers()) {
    if (options.arrangement != Arrangement::kSail) {
      throw InputError("--Plan.surface: a layout's lines are placed on a sail; leave it out");
    }
    placement = PlaceLinesOnSail(options.sail, layout, sticker_mm);
  } else {
    placement = options.arrangement == Arrangement::kSail
                    ? PlaceOnSail(options.sail, length_mm, sticker_mm, 0)
                    : PlaceOnGrid(options.grid, length_mm, sticker_mm, 0);
    layout.parts = {PartOfPlacement(placement)};
    if (options.sail.hull_markers > 0) {
      layout.parts.push_back(
          RigidPart("hull", MarkerIds(layout).back() + 1, options.sail.hull_markers));
    }
  }
  return SurfaceOfPlacement(placement, layout, options.plan.camber, options.plan.twist_deg);
}

PlannedSurface MakeSurface(const ShootPlannerCommandOptions& options) {
  if (options.paths.shape_path.empty()) return PlaceMarkers(options);
  const std::string file = ShapeFile(options.paths.shape_path);
  const MarkerShape shape = ReadShapeCsv(file);
  CheckMetres(file, shape, options.layout);
  return SurfaceOfShape(shape, options.layout, file);
}

void WritePlan(const ShootPlan& plan, const std::filesystem::path& folder) {
  WriteFile(folder / "plan.csv", [&](std::ostream& out) { WritePlanCsv(plan, out); });
  WriteFile(folder / "markers.csv", [&](std::ostream& out) { WriteMarkersCsv(plan, out); });
  WriteFile(folder / "plan.svg", [&](std::ostream& out) { out << SvgText(DrawPlan(plan)); });
}

void Run(const ShootPlannerCommandOptions& options) {
  const std::string& output_path = options.paths.output_path;
  std::optional<AtomicFolder> folder;
  if (!output_path.empty()) folder.emplace(output_path);
  const std::optional<Camera> calibration = LoadCalibration(options.paths);
  const Camera camera = calibration ? *calibration : CameraOfFieldOfView(options.plan);
  Progress progress("simulating paths");
  const ShootPlan plan = MakeShootPlan(
      MakeSurface(options), camera, options.plan,
      [&](int done, int total, const std::string& what) { progress.Update(done, total, what); });
  ClearProgressLine();
  if (folder) {
    WritePlan(plan, folder->TemporaryPath());
    folder->Commit();
  }
  PrintPlan(plan, std::cout);
  if (folder) std::cout << fmt::format("\noutput_path: {}\n", output_path);
}

}  // namespace

Command ShootPlanner() { return MakeCommand<ShootPlannerCommandOptions>(Declare, Validate, Run); }

}  // namespace velamap
