#include "exporters/freeform/freeform_shape.h"

#include <ostream>
#include <set>

#include <fmt/format.h>

#include "exporters/formats/mesh_writer.h"
#include "exporters/shape/sail_lines.h"
#include "exporters/shape/shape_sigma.h"
#include "exporters/surface/surface_attempt.h"
#include "importer/base/atomic_output.h"
#include "importer/geometry/units.h"
#include "importer/text/csv.h"

namespace velamap {
namespace {

constexpr std::size_t kMaxSurfaces = 50;

struct FreeformPart {
  std::string name;
  std::set<int> marker_ids;
};

std::vector<FreeformPart> FreeformParts(const MarkerShape& shape, const Layout& layout) {
  std::vector<FreeformPart> parts;
  for (const LayoutPart& part : layout.parts) {
    if (!part.horizontal.empty()) continue;
    const std::vector<int> ids = MarkersOfPart(layout, part.name);
    parts.push_back({part.name, {ids.begin(), ids.end()}});
  }
  if (!layout.HasMarkers()) {
    parts.push_back({});
    for (const ShapeMarker& marker : shape.markers) parts[0].marker_ids.insert(marker.marker_id);
  }
  return parts;
}

// Says that the surface lacks markers of the part, so that its area is not that of the whole part.
void NoteMissingMarkers(std::size_t num_whole, std::size_t num_of_part, FreeformSurface* surface) {
  const std::size_t num_missing = num_of_part - num_whole;
  if (num_missing == 0) return;
  surface->notes.push_back(
      fmt::format("{} of {} markers {} not whole; the surface ends at the others", num_missing,
                  num_of_part, num_missing == 1 ? "is" : "are"));
}

FreeformSurface FitPart(const MarkerShape& shape, const FreeformPart& part, const Layout& layout,
                        const PointCovariance* own_covariance,
                        const std::optional<MeshOptions>& mesh, int num_threads) {
  std::vector<FreeformMarker> markers;
  for (const int id : part.marker_ids) {
    const ShapeMarker* marker = FindWholeMarker(shape, id);
    if (marker != nullptr) markers.push_back(MakeFreeformMarker(*marker, own_covariance));
  }
  FreeformSurface surface = FitFreeformSurface(markers, layout.marker_length_m, mesh, num_threads);
  NoteMissingMarkers(markers.size(), part.marker_ids.size(), &surface);
  return surface;
}

void WriteResiduals(const FreeformShape& freeform, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("part", "marker_id", "corner", "distance", "sigma", "surface_sigma");
  for (const PartSurface& part : freeform.surfaces) {
    for (const FreeformResidual& residual : part.surface.residuals) {
      csv.WriteRecord(part.part, residual.marker_id, residual.corner, residual.distance_m,
                      residual.sigma_m, residual.surface_sigma_m);
    }
  }
}

}  // namespace

std::string ShownName(const std::string& part) { return part.empty() ? "all markers" : part; }

std::string SizeText(const FreeformSurface& surface) {
  constexpr double kSmall_m2 = 0.1, kMm2PerM2 = kMmPerM * kMmPerM;
  const bool is_small = surface.area_m2 < kSmall_m2;
  std::string text = is_small ? fmt::format("{:.0f} mm2", kMm2PerM2 * surface.area_m2)
                              : fmt::format("{:.4g} m2", surface.area_m2);
  if (!surface.volume_m3) return text;
  text += is_small ? fmt::format(", closed, {:.0f} mm3", kMm2PerM2 * kMmPerM * *surface.volume_m3)
                   : fmt::format(", closed, {:.4g} m3", *surface.volume_m3);
  return text;
}

FreeformShape ComputeFreeform(const MarkerShape& shape, const Layout& layout,
                              const PointCovariance* covariance,
                              const std::optional<MeshOptions>& mesh, int num_threads) {
  const std::optional<PointCovariance> own = WithoutSharedErrors(covariance);
  FreeformShape freeform;
  for (const FreeformPart& part : FreeformParts(shape, layout)) {
    if (part.marker_ids.size() < kMinFreeformMarkers) continue;
    const std::string name = ShownName(part.name);
    const std::size_t number = freeform.surfaces.size() + 1;
    if (number > kMaxSurfaces) {
      freeform.notes.push_back(fmt::format(
          "{}: no surface: at most {} parts without horizontal lines get one", name, kMaxSurfaces));
      continue;
    }
    const auto fit = [&] {
      freeform.surfaces.push_back(
          {part.name, number == 1 ? "freeform" : fmt::format("freeform_{}", number),
           FitPart(shape, part, layout, own ? &*own : nullptr, mesh, num_threads)});
      return freeform.surfaces.back().surface.notes;
    };
    TryFitSurface(name, fit, &freeform.notes, &freeform.surface_error);
  }
  return freeform;
}

void WriteFreeformFiles(const FreeformShape& freeform, const ShapeFrame& frame, LengthUnit unit,
                        PlyFormat ply_format, const std::filesystem::path& folder) {
  for (const PartSurface& part : freeform.surfaces) {
    const std::string title = fmt::format("{} (frame: {})", ShownName(part.part), frame.name);
    const auto write = [&](const std::string& extension, const auto& writer) {
      WriteFile(folder / (part.file_stem + extension), writer);
    };
    const TriangleMesh& mesh = part.surface.mesh;
    write(".ply", [&](std::ostream& out) { WriteMeshPly(mesh, title, ply_format, out); });
    write(".obj", [&](std::ostream& out) { WriteMeshObj(mesh, title, unit, out); });
    write(".stl", [&](std::ostream& out) { WriteMeshStl(mesh, title, unit, out); });
  }
  if (freeform.surfaces.empty()) return;
  WriteFile(folder / "freeform_residuals.csv",
            [&](std::ostream& out) { WriteResiduals(freeform, out); });
}

}  // namespace velamap
