// Triangle meshes of spline surfaces.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "exporters/formats/surface_spline.h"
#include "importer/base/option.h"

namespace velamap {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<Eigen::Vector3d> normals;             // one unit vector per vertex, or empty
  std::vector<Eigen::Vector2d> surface_parameters;  // one (u, v) per vertex, or empty
  std::vector<std::array<int, 3>> triangles;        // counter-clockwise seen from the outside
  std::vector<double> sigmas_m;                     // one per vertex, along its normal, or empty
};

struct MeshOptions {
  // Exactly one of the two: the longest edge along the grid lines (diagonals are up to 1.42 times
  // as long where these cross at right angles, and below twice as long elsewhere), or the largest
  // distance of the triangles from the surface.
  std::optional<double> edge_length_mm;
  std::optional<double> chord_deviation_mm;

  // Throws InputError for none or both of them and for a value that is not positive.
  void Check() const;
};

OptionGroup DescribeOptions(MeshOptions* options);

// Edges of half a marker's side, or longer ones to stay below 100 000 triangles.
MeshOptions DefaultMeshOptions(const SplineSurface& surface, double marker_length_m);

// Upper bound of the number of triangles of MeshSurface(), also above kMaxTriangles.
double CountTriangles(const SplineSurface& surface, const MeshOptions& options);

constexpr int kMaxTriangles = 5'000'000;

// Makes a grid with equal steps in u and in v and two triangles per cell. Cells that degenerate to
// a line (a head that ends in a point) have one or none. Throws InputError if the mesh would have
// more than kMaxTriangles.
TriangleMesh MeshSurface(const SplineSurface& surface, const MeshOptions& options);

}  // namespace velamap
