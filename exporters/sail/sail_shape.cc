#include "exporters/sail/sail_shape.h"

#include <functional>
#include <iosfwd>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "exporters/cloth/cloth_places.h"
#include "exporters/cloth/surface_sigma.h"
#include "exporters/formats/cad_writer.h"
#include "exporters/formats/mesh_writer.h"
#include "exporters/sail/section_drawing.h"
#include "exporters/sail/section_writer.h"
#include "exporters/surface/surface_attempt.h"
#include "exporters/surface/surface_csv.h"
#include "exporters/surface/surface_input.h"
#include "importer/base/atomic_output.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

// A boat has a few sails. Further parts with lines get no surface.
constexpr int kMaxSurfaces = 20;

// A given edge that is far from all markers is in another unit or frame.
void CheckEdges(const MarkerShape& shape, const SurfaceEdges& edges) {
  Eigen::AlignedBox3d box;
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.IsWhole()) box.extend(*marker.x_in_shape_m[0]);
  }
  if (box.isEmpty()) return;
  const double size_m = box.diagonal().norm();
  for (const auto* edge : {&edges.luff, &edges.leech, &edges.foot, &edges.head}) {
    for (const Eigen::Vector3d& x_m : edge->points_m) {
      const double distance_m = box.exteriorDistance(x_m);
      if (distance_m <= size_m) continue;
      throw InputError(fmt::format(
          "--Surface.edges_path: the point {:g}, {:g}, {:g} is {:.3g} m from the markers, expected "
          "at most {:.3g} m, the extent of the markers; give coordinates in m, in the frame of the "
          "result",
          x_m.x(), x_m.y(), x_m.z(), distance_m, size_m));
    }
  }
}

SailSurface MakeSailSurface(const MarkerShape& shape, const ShapeFrame& frame, const Layout& layout,
                            const LayoutPart& part, const PointCovariance* covariance,
                            const SailOptions& options) {
  SailSurface surface;
  surface.part = part.name;
  SurfaceOptions of_part = options.surface;
  // The points of a file are on the edges of one sail.
  if (&part != FirstPartWithLines(layout)) of_part.edges = {};
  CheckEdges(shape, of_part.edges);
  surface.fit = FitSurface(CollectSurfaceInput(shape, part, frame.up_in_frame), of_part);
  surface.area_m2 = SurfaceArea(surface.fit.surface);
  surface.rms_sigma_m = RmsSigma(surface.fit, covariance);
  surface.mesh = MeshSurface(
      surface.fit.surface,
      options.mesh.value_or(DefaultMeshOptions(surface.fit.surface, layout.marker_length_m)));
  return surface;
}

// The sections of a part as curves, and the centres of its whole markers as points.
CadExtras ExtrasOf(const std::string& part, const SectionReport& report, const MarkerShape& shape) {
  CadExtras extras;
  for (const Section& section : report.sections) {
    if (section.part != part) continue;
    extras.curves.push_back(
        {section.name, section.curve.degree, section.curve.knots, section.curve.poles_in_shape_m});
  }
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.part != part || !marker.IsWhole()) continue;
    extras.points.push_back({fmt::format("{}", marker.marker_id), *marker.x_in_shape_m[0]});
  }
  return extras;
}

using Writer = std::function<void(std::ostream&)>;

void WriteSurfaceFiles(const SailSurface& surface, CadExtras extras, const std::string& title,
                       const std::string& suffix, const SailFileOptions& options,
                       const std::filesystem::path& folder) {
  const SplineSurface& spline = surface.fit.surface;
  const SurfaceGrid grid = MakeGrid(spline, options.grid);
  const std::string stem = "surface" + suffix;
  extras.iges_file_name = stem + ".igs";
  const std::vector<std::pair<std::string, Writer>> files = {
      {stem + ".step", [&](std::ostream& out) { WriteStep(spline, title, out, extras); }},
      {stem + ".igs", [&](std::ostream& out) { WriteIges(spline, title, out, extras); }},
      {stem + ".ply",
       [&](std::ostream& out) { WriteMeshPly(surface.mesh, title, options.Ply(), out); }},
      {stem + ".obj",
       [&](std::ostream& out) { WriteMeshObj(surface.mesh, title, options.unit, out); }},
      {stem + ".stl",
       [&](std::ostream& out) { WriteMeshStl(surface.mesh, title, options.unit, out); }},
      {stem + ".vts", [&](std::ostream& out) { WriteGridVts(grid, title, out); }},
      {stem + ".msh", [&](std::ostream& out) { WriteGridMsh(grid, title, options.unit, out); }},
      {stem + "_ansys.txt",
       [&](std::ostream& out) { WriteGridAnsys(grid, title, options.unit, out); }},
      {"surface_residuals" + suffix + ".csv",
       [&](std::ostream& out) { WriteSurfaceResidualsCsv(surface.fit, out); }},
      {"surface_edges" + suffix + ".csv",
       [&](std::ostream& out) { WriteSurfaceEdgesCsv(surface.fit, out); }}};
  for (const auto& [name, writer] : files) WriteFile(folder / name, writer);
}

void WriteSectionFiles(const SectionReport& report, const ShapeFrame& frame, LengthUnit unit,
                       const std::filesystem::path& folder) {
  const std::vector<std::pair<std::string, Writer>> files = {
      {"sections.csv", [&](std::ostream& out) { WriteSectionsCsv(report, out); }},
      {"sections.json", [&](std::ostream& out) { WriteSectionsJson(report, frame, out); }},
      {"sections.dxf", [&](std::ostream& out) { WriteSectionsDxf(report, frame, unit, out); }},
      {"section_profiles.csv", [&](std::ostream& out) { WriteSectionProfilesCsv(report, out); }},
      {"section_profiles.dxf",
       [&](std::ostream& out) { WriteSectionProfilesDxf(report, frame, unit, out); }},
      {"section_profiles.svg",
       [&](std::ostream& out) { WriteSectionProfilesSvg(report, frame, out); }}};
  for (const auto& [name, writer] : files) WriteFile(folder / name, writer);
}

}  // namespace

void SailOptions::Check() const {
  sections.Check();
  surface.Check();
  if (mesh) mesh->Check();
}

SailShape ComputeSail(const MarkerShape& shape, const ShapeFrame& frame, const Layout& layout,
                      const PointCovariance* covariance, const SailOptions& options) {
  options.Check();
  SailShape sail;
  MarkerShape on_cloth = shape;
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty()) continue;
    if (static_cast<int>(sail.surfaces.size()) == kMaxSurfaces) {
      sail.surface_notes.push_back(
          fmt::format("{}: no surface: at most {} parts get one", part.name, kMaxSurfaces));
      continue;
    }
    const auto fit = [&] {
      sail.surfaces.push_back(MakeSailSurface(shape, frame, layout, part, covariance, options));
      MoveCenters(OffsetsToCloth(sail.surfaces.back().fit), &on_cloth);
      return sail.surfaces.back().fit.notes;
    };
    TryFitSurface(part.name, fit, &sail.surface_notes, &sail.surface_error);
  }
  sail.sections = ComputeSections(on_cloth, frame, layout, covariance, options.sections);
  return sail;
}

void WriteSailFiles(const SailShape& sail, const MarkerShape& shape, const ShapeFrame& frame,
                    const SailFileOptions& options, const std::filesystem::path& folder) {
  if (!sail.sections.sections.empty() || !sail.sections.missing.empty()) {
    WriteSectionFiles(sail.sections, frame, options.unit, folder);
  }
  for (std::size_t i = 0; i < sail.surfaces.size(); ++i) {
    const SailSurface& surface = sail.surfaces[i];
    const std::string suffix = i == 0 ? "" : fmt::format("_{}", i + 1);
    WriteSurfaceFiles(surface, ExtrasOf(surface.part, sail.sections, shape),
                      fmt::format("{} (frame: {})", surface.part, frame.name), suffix, options,
                      folder);
  }
}

}  // namespace velamap
