#include "workflows/commands/report_design.h"

#include <filesystem>

#include <fmt/format.h>

#include "exporters/cloth/cloth_places.h"
#include "exporters/compare/section_comparison.h"
#include "exporters/compare/shape_deviation.h"
#include "exporters/sail/section_writer.h"
#include "exporters/shape/shape_transform.h"
#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/geometry/units.h"
#include "workflows/commands/compared_shapes.h"
#include "workflows/options/option_effects.h"

namespace velamap {
namespace {

// The part whose design it is: the one with lines. Empty for all markers where several have lines.
std::string PartOfDesign(const Layout& layout) {
  std::string name;
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty()) continue;
    if (!name.empty()) return "";
    name = part.name;
  }
  return name;
}

void FitDesign(const DesignOptions& options, const MeshDistance& design,
               const ShapeExportReport& shape, const Layout& layout,
               const SectionOptions& section_options, ReportInput* input) {
  CheckUnit(options.path, options.mesh, "design_unit", shape.shape, design);
  CheckFaces(options.path, design);
  const ShapeDeviation deviation =
      CompareWithMesh({shape.shape, {}}, design, layout, {}, PartOfDesign(layout));
  if (deviation.doubt) LogWarning("{}: {}", options.path, deviation.doubt->reason);
  MarkerShape of_design = MarkersOnSurface(deviation);
  MoveShape(Inverse(deviation.alignment.reference_from_shape), nullptr, &of_design);
  MoveCenters(OffsetsToCloth(of_design, layout, shape.frame.up_in_frame), &of_design);
  const SectionReport sections =
      ComputeSections(of_design, shape.frame, layout, nullptr, section_options);
  ReportDesign result{std::filesystem::path(options.path).filename().string(),
                      deviation.distance_m.count, kMmPerM * deviation.distance_m.rms};
  for (const Section& measured : shape.sail.sections.sections) {
    std::vector<Eigen::Vector2d>& profile_m = result.profiles_m.emplace_back();
    const Section* planned = FindSection(sections, measured.part, measured.name);
    if (planned == nullptr) continue;
    for (const ProfilePoint& point : SampleProfile(*planned, kNumProfilePoints)) {
      const ProfilePoint placed = ProfilePointOf(measured, point.x_in_frame_m);
      profile_m.emplace_back(placed.chordwise_m, placed.depth_m);
    }
  }
  input->design = std::move(result);
}

}  // namespace

OptionGroup DescribeOptions(DesignOptions* options) {
  return {
      "Report",
      {Common(PathOption("design_path", PathUse::kReadsFile, &options->path,
                         "surface of the sail's design as .step, .iges, .ply, .stl or .obj: the "
                         "report draws its sections beside the measured ones")),
       MeshUnitOption("design_unit", &options->mesh)}};
}

void CheckDesign(const DesignOptions& options, const TypedNames& typed) {
  if (options.path.empty()) {
    RefuseOptionsWithoutEffect(typed, {"design_unit"}, "there is no --design_path");
  } else if (!IsMeshPath(options.path)) {
    throw InputError(
        fmt::format("--design_path: {} is not a surface; give a .step, .iges, .ply, .stl or .obj",
                    options.path));
  } else if (HasOwnUnit(options.path)) {
    RefuseOptionsWithoutEffect(typed, {"design_unit"},
                               "the --design_path " + options.path + " names its unit itself");
  }
}

std::unique_ptr<MeshDistance> ReadDesign(const DesignOptions& options) {
  if (options.path.empty()) return nullptr;
  return std::make_unique<MeshDistance>(ReadMesh(options.path, options.mesh));
}

void AddDesign(const DesignOptions& options, const MeshDistance& design,
               const ShapeExportReport& shape, const Layout& layout,
               const SectionOptions& section_options, ReportInput* input) {
  try {
    FitDesign(options, design, shape, layout, section_options, input);
  } catch (const InputError& error) {
    LogWarning("the report does not show the design: {}", error.what());
  } catch (const DataError& error) {
    LogWarning("the report does not show the design: {}", error.what());
  }
}

}  // namespace velamap
