#include "exporters/compare/surface_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include <fmt/format.h>

#include "exporters/formats/diverging_color.h"
#include "exporters/sail/surface.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

// Edges of half a marker's side, or longer where that were more than 100 000 triangles.
TriangleMesh MeshOf(const MarkerShape& shape, const LayoutPart& part, const Layout& layout) {
  const SplineSurface surface = FitSurface(CollectSurfaceInput(shape, part)).surface;
  return MeshSurface(surface, DefaultMeshOptions(surface, layout.marker_length_m));
}

SurfaceDeviation Measure(const std::string& part, TriangleMesh mesh,
                         const MeshDistance& reference) {
  SurfaceDeviation deviation;
  deviation.part = part;
  std::vector<double> known_m;
  for (const Eigen::Vector3d& x : mesh.vertices_m) {
    const MeshFoot foot = reference.Project(x);
    deviation.distance_m.emplace_back();
    if (!foot.IsOverSurface(reference.Diagonal_m())) continue;
    deviation.distance_m.back() = foot.distance_m;
    known_m.push_back(foot.distance_m);
  }
  deviation.mesh = std::move(mesh);
  deviation.statistics_m = ComputeStatistics(std::move(known_m));
  return deviation;
}

// `measure` compares one part's mesh and throws DataError where the reference has none.
template <typename Function>
SurfaceComparison CompareParts(const MarkerShape& shape, const Layout& layout,
                               const std::string& wanted_part, const Function& measure) {
  SurfaceComparison comparison;
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty() || (!wanted_part.empty() && part.name != wanted_part)) continue;
    try {
      comparison.parts.push_back(measure(part, MeshOf(shape, part, layout)));
    } catch (const DataError& error) {
      comparison.notes.push_back(fmt::format("{}: no surface: {}", part.name, error.what()));
    }
  }
  return comparison;
}

std::string Header(const SurfaceComparison& comparison, double limit_m) {
  std::size_t num_vertices = 0, num_triangles = 0;
  for (const SurfaceDeviation& part : comparison.parts) {
    num_vertices += part.mesh.vertices_m.size();
    num_triangles += part.mesh.triangles.size();
  }
  return fmt::format(
      "ply\nformat ascii 1.0\n"
      "comment velamap comparison of surfaces, metres, frame of the reference\n"
      "comment distance: positive on the side of the reference's normal\n"
      "comment colours: blue -{0:g} mm, white 0, red +{0:g} mm, grey beside the reference\n"
      "element vertex {1}\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float distance\n"
      "element face {2}\nproperty list uchar int vertex_indices\nend_header\n",
      1e3 * limit_m, num_vertices, num_triangles);
}

}  // namespace

SurfaceComparison CompareSurfaces(const MarkerShape& aligned_shape, const MarkerShape& reference,
                                  const Layout& layout, const std::string& part) {
  return CompareParts(aligned_shape, layout, part, [&](const LayoutPart& p, TriangleMesh mesh) {
    return Measure(p.name, std::move(mesh), MeshDistance(MeshOf(reference, p, layout)));
  });
}

SurfaceComparison CompareSurfaces(const MarkerShape& aligned_shape, const MeshDistance& reference,
                                  const Layout& layout, const std::string& part) {
  return CompareParts(aligned_shape, layout, part, [&](const LayoutPart& p, TriangleMesh mesh) {
    return Measure(p.name, std::move(mesh), reference);
  });
}

double LargestDistance(const SurfaceComparison& comparison) {
  double largest_m = 0.0;
  for (const SurfaceDeviation& part : comparison.parts) {
    if (part.statistics_m.count == 0) continue;
    largest_m =
        std::max({largest_m, std::abs(part.statistics_m.min), std::abs(part.statistics_m.max)});
  }
  return largest_m;
}

void WriteComparisonSurfacePly(const SurfaceComparison& comparison,
                               std::optional<double> color_limit_m, std::ostream& out) {
  const double limit_m = color_limit_m.value_or(LargestDistance(comparison));
  std::string vertices, triangles;
  int first = 0;
  for (const SurfaceDeviation& part : comparison.parts) {
    for (std::size_t i = 0; i < part.mesh.vertices_m.size(); ++i) {
      const Eigen::Vector3d& x = part.mesh.vertices_m[i];
      const Eigen::Array3d color = DivergingColor(part.distance_m[i], limit_m);
      vertices += fmt::format("{} {} {} {:.0f} {:.0f} {:.0f} ", x.x(), x.y(), x.z(), color[0],
                              color[1], color[2]);
      vertices += part.distance_m[i] ? fmt::format("{}\n", static_cast<float>(*part.distance_m[i]))
                                     : std::string("nan\n");
    }
    for (const auto& [a, b, c] : part.mesh.triangles) {
      triangles += fmt::format("3 {} {} {}\n", first + a, first + b, first + c);
    }
    first += static_cast<int>(part.mesh.vertices_m.size());
  }
  out << Header(comparison, limit_m) << vertices << triangles;
}

}  // namespace velamap
