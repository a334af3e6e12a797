#include "exporters/compare/surface_comparison.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "exporters/surface/surface.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

TriangleMesh MeshOf(const FittedSurface& fit, const Layout& layout) {
  return MeshSurface(fit.surface, DefaultMeshOptions(fit.surface, layout.marker_length_m));
}

// The surface of the reference, turned so that its triangles face as most of the markers do.
TriangleMesh FacingMesh(const ShapeSurfaces& reference, const LayoutPart& part,
                        const Layout& layout) {
  const FittedSurface& fit = reference.Of(part);
  TriangleMesh mesh = MeshOf(fit, layout);
  if (FacesLikeMarkers(fit, reference.shape())) return mesh;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

SurfaceDeviation Measure(const std::string& part, TriangleMesh mesh, const MeshDistance& reference,
                         const EdgeOptions& edge) {
  const double reach_m = kMPerMm * edge.tolerance_mm;
  SurfaceDeviation deviation;
  deviation.part = part;
  std::vector<double> known_m;
  for (const Eigen::Vector3d& x : mesh.vertices_m) {
    const MeshFoot foot = reference.Project(x);
    deviation.distance_m.emplace_back();
    if (!foot.IsWithin(reach_m, reference.Diagonal_m())) continue;
    deviation.distance_m.back() = foot.distance_m;
    known_m.push_back(foot.distance_m);
  }
  deviation.mesh = std::move(mesh);
  deviation.statistics_m = ComputeStatistics(std::move(known_m));
  return deviation;
}

// `measure` compares the mesh of one part. It throws DataError if the reference has no surface
// there.
template <typename Function>
SurfaceComparison CompareEachPart(const ShapeSurfaces& shape, const Layout& layout,
                                  const std::string& wanted_part, const Function& measure) {
  SurfaceComparison comparison;
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty() || (!wanted_part.empty() && part.name != wanted_part)) continue;
    try {
      comparison.parts.push_back(measure(part, MeshOf(shape.Of(part), layout)));
    } catch (const DataError& error) {
      comparison.notes.push_back(fmt::format("{}: no surface: {}", part.name, error.what()));
    }
  }
  return comparison;
}

}  // namespace

SurfaceComparison CompareSurfaces(const ShapeSurfaces& aligned_shape,
                                  const ShapeSurfaces& reference, const Layout& layout,
                                  const std::string& part, const EdgeOptions& edge) {
  return CompareEachPart(aligned_shape, layout, part, [&](const LayoutPart& p, TriangleMesh mesh) {
    return Measure(p.name, std::move(mesh), MeshDistance(FacingMesh(reference, p, layout)), edge);
  });
}

SurfaceComparison CompareSurfaces(const ShapeSurfaces& aligned_shape, const MeshDistance& reference,
                                  const Layout& layout, const std::string& part,
                                  const EdgeOptions& edge) {
  return CompareEachPart(aligned_shape, layout, part, [&](const LayoutPart& p, TriangleMesh mesh) {
    return Measure(p.name, std::move(mesh), reference, edge);
  });
}

double LargestDistance(const SurfaceComparison& comparison) {
  double largest_m = 0.0;
  for (const SurfaceDeviation& part : comparison.parts) {
    largest_m = std::max(largest_m, part.statistics_m.MaxAbs());
  }
  return largest_m;
}

}  // namespace velamap
