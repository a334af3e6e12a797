#include "exporters/formats/mesh_triangles.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

struct GridSize {
  double num_u = 1, num_v = 1;  // cells; double, because a refused mesh may have more than 2^31
};

struct Extremes {
  double speed_u = 0, speed_v = 0;               // largest |S_u|, |S_v|, m
  double bend_uu = 0, bend_uv = 0, bend_vv = 0;  // largest |second derivative|, m
};

// Uses the whole second derivative and not only its normal part, because near a fold of the
// parameters the chord also deviates within the tangent plane.
Extremes FindExtremes(const SplineSurface& surface) {
  Extremes extremes;
  const std::vector<double> vs = SpanSamples(surface.knots_v);
  for (const double u : SpanSamples(surface.knots_u)) {
    for (const double v : vs) {
      const SurfaceJet jet = EvaluateJet(surface, u, v);
      extremes.speed_u = std::max(extremes.speed_u, jet.x_u.norm());
      extremes.speed_v = std::max(extremes.speed_v, jet.x_v.norm());
      extremes.bend_uu = std::max(extremes.bend_uu, jet.x_uu.norm());
      extremes.bend_uv = std::max(extremes.bend_uv, jet.x_uv.norm());
      extremes.bend_vv = std::max(extremes.bend_vv, jet.x_vv.norm());
    }
  }
  return extremes;
}

// A linear triangle with legs h and k deviates by at most (h^2 S_uu + 2 h k S_uv + k^2 S_vv) / 8.
double Deviation(const Extremes& extremes, const GridSize& grid) {
  return (extremes.bend_uu / (grid.num_u * grid.num_u) +
          2 * extremes.bend_uv / (grid.num_u * grid.num_v) +
          extremes.bend_vv / (grid.num_v * grid.num_v)) /
         8;
}

GridSize ChooseGrid(const SplineSurface& surface, const MeshOptions& options) {
  const Extremes extremes = FindExtremes(surface);
  if (options.edge_length_mm) {
    const double edge_m = *options.edge_length_mm / kMmPerM;
    return {std::max(1.0, std::ceil(extremes.speed_u / edge_m)),
            std::max(1.0, std::ceil(extremes.speed_v / edge_m))};
  }
  // Square cells give the lowest bound of the mixed term.
  const double deviation_m = *options.chord_deviation_mm / kMmPerM;
  const double ratio = std::clamp(extremes.speed_u / extremes.speed_v, 1e-2, 1e2);
  const double needed = Deviation(extremes, {std::sqrt(ratio), 1 / std::sqrt(ratio)}) / deviation_m;
  const double factor = std::sqrt(needed);
  return {std::max(1.0, std::ceil(factor * std::sqrt(ratio))),
          std::max(1.0, std::ceil(factor / std::sqrt(ratio)))};
}

void CheckCount(const GridSize& grid, const MeshOptions& options) {
  const double num_triangles = 2 * grid.num_u * grid.num_v;
  if (num_triangles <= kMaxTriangles) return;
  // Multiplies roots, because the number itself may be infinite.
  const double root_of_excess = std::sqrt(grid.num_u) * std::sqrt(2 * grid.num_v / kMaxTriangles);
  const auto member =
      options.edge_length_mm ? &MeshOptions::edge_length_mm : &MeshOptions::chord_deviation_mm;
  const double given = *(options.*member);
  // The number is proportional to the inverse square of the edge length and to the inverse of the
  // deviation.
  const double possible = given * root_of_excess * (options.edge_length_mm ? 1.0 : root_of_excess);
  throw InputError(
      fmt::format("{}: {:.3g} mm would need {:.4g} triangles, more than {}; give {:.2g} mm or more",
                  OptionName(member), given, num_triangles, kMaxTriangles, 1.1 * possible));
}

}  // namespace

OptionGroup DescribeOptions(MeshOptions* options) {
  return {"Mesh of the surface",
          {{"Surface.edge_length", &options->edge_length_mm, "mm",
            "longest edge of the mesh; left out: half a marker's side", MoreThan(0)},
           {"Surface.chord_deviation", &options->chord_deviation_mm, "mm",
            "instead: how far the mesh may be from the surface", MoreThan(0)}}};
}

void MeshOptions::Check() const {
  if (edge_length_mm.has_value() == chord_deviation_mm.has_value()) {
    throw InputError(fmt::format("{} and {}: give one of the two",
                                 OptionName(&MeshOptions::edge_length_mm),
                                 OptionName(&MeshOptions::chord_deviation_mm)));
  }
  CheckRanges(*this);
}

double CountTriangles(const SplineSurface& surface, const MeshOptions& options) {
  options.Check();
  const GridSize grid = ChooseGrid(surface, options);
  return 2 * grid.num_u * grid.num_v;
}

TriangleMesh MeshSurface(const SplineSurface& surface, const MeshOptions& options) {
  options.Check();
  const GridSize grid = ChooseGrid(surface, options);
  CheckCount(grid, options);
  const int num_u = static_cast<int>(grid.num_u), num_v = static_cast<int>(grid.num_v);
  TriangleMesh mesh;
  for (int i = 0; i <= num_u; ++i) {
    for (int j = 0; j <= num_v; ++j) {
      const double u = static_cast<double>(i) / num_u, v = static_cast<double>(j) / num_v;
      mesh.vertices_m.push_back(EvaluatePoint(surface, u, v));
      mesh.normals.push_back(EvaluateNormal(surface, u, v));
      mesh.surface_parameters.emplace_back(u, v);
    }
  }
  const auto add = [&mesh](int a, int b, int c) {
    const auto& x = mesh.vertices_m;
    if ((x[b] - x[a]).cross(x[c] - x[a]).norm() > 1e-15) mesh.triangles.push_back({a, b, c});
  };
  for (int i = 0; i < num_u; ++i) {
    for (int j = 0; j < num_v; ++j) {
      const int corner = i * (num_v + 1) + j, next = corner + num_v + 1;
      add(corner, next, next + 1);
      add(corner, next + 1, corner + 1);
    }
  }
  return mesh;
}

MeshOptions DefaultMeshOptions(const SplineSurface& surface, double marker_length_m) {
  constexpr double kEnoughTriangles = 1e5, kCoarser = 1.5;
  MeshOptions options;
  options.edge_length_mm =
      kMmPerM *
      std::max(marker_length_m / 2, std::sqrt(2 * SurfaceArea(surface) / kEnoughTriangles));
  while (CountTriangles(surface, options) > 2 * kEnoughTriangles) {
    *options.edge_length_mm *= kCoarser;
  }
  return options;
}

}  // namespace velamap
