// Triangle meshes of spline surfaces.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "exporters/formats/surface_spline.h"

namespace velamap {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<Eigen::Vector3d> normals;             // one a vertex, unit length; or empty
  std::vector<Eigen::Vector2d> surface_parameters;  // (u, v), one a vertex; or empty
  std::vector<std::array<int, 3>> triangles;        // counter-clockwise seen against the normal
};

struct MeshOptions {
  // How fine: exactly one of the two. Longest edge along the grid lines (diagonals are up to 1.42
  // times as long), or how far the triangles may be from the surface.
  std::optional<double> edge_length_mm;
  std::optional<double> chord_deviation_mm;

  // Throws InputError for none, both, or a value that is not positive.
  void Check() const;
};

// Edges of half a marker's side, longer where that would be more than 100 000 triangles.
MeshOptions DefaultMeshOptions(const SplineSurface& surface, double marker_length_m);

// Triangles that MeshSurface would make, also where it would refuse to; not fewer than it makes.
double CountTriangles(const SplineSurface& surface, const MeshOptions& options);

constexpr int kMaxTriangles = 5'000'000;

// A grid in u and v with equal steps in each, two triangles a cell; cells that shrink to a line (a
// head that ends in a point) have one or none. Throws InputError, with the number of triangles that
// it would take, above kMaxTriangles.
TriangleMesh MeshSurface(const SplineSurface& surface, const MeshOptions& options);

}  // namespace velamap
