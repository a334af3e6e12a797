// Signed distances of points to a triangle mesh.
//
// Open CASCADE's bounding volume hierarchy finds the nearest triangle; the foot on it is exact. The
// angle-weighted normal at the foot gives the sign, also on edges and vertices (Baerentzen and
// Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE TVCG 11(3),
// 2005).

#pragma once

#include <memory>

#include <Eigen/Core>

#include "exporters/formats/mesh_triangles.h"
#include "importer/base/option.h"

namespace velamap {

// Which points beyond the border of a surface still count. Noise, and cloth that reaches beyond the
// design's edge, put about half of the markers on luff, leech, foot and head beyond the border. The
// distance of a point is the one along the normal at the border, as if the surface continued
// straight: 20 mm beyond the border of a surface with a curvature of 1/m, it is 0.2 mm off. That of
// a marker counts the bend as well (marker_distance.h).
struct EdgeOptions {
  double tolerance_mm = 20.0;
  double num_sigmas = 3.0;  // of the marker's position across the border, if that is farther

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(EdgeOptions* options);

struct MeshFoot {
  Eigen::Vector3d x_m = Eigen::Vector3d::Zero();  // nearest point of the mesh
  // At x_m, unit length. On an edge or vertex between triangles it points along the line to the
  // point, so that the point less distance_m times the normal is on the mesh.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  // Distance, positive on the side to which the normal points. If the foot is on the border of the
  // mesh, the distance along the normal; beside_m is the distance within the tangent plane.
  double distance_m = 0.0;
  double beside_m = 0.0;

  // Whether the line to the foot is along the normal, to 1e-4 of the mesh's diagonal. Otherwise the
  // point lies beside the surface and has no distance from it.
  bool IsOverSurface(double diagonal_m) const { return beside_m <= 1e-4 * diagonal_m; }

  // The same for points up to `reach_m` beyond the border.
  bool IsWithin(double reach_m, double diagonal_m) const {
    return beside_m <= reach_m || IsOverSurface(diagonal_m);
  }
};

// Moments of the surface, weighted by area.
struct MeshMoments {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

// Keeps no reference to the mesh. Merges vertices within 1e-8 of the extent of the mesh, because
// STL files and the faces of CAD files share no vertices.
class MeshDistance {
 public:
  // The mesh must have a triangle with a positive area.
  explicit MeshDistance(const TriangleMesh& mesh);
  ~MeshDistance();
  MeshDistance(const MeshDistance&) = delete;
  MeshDistance& operator=(const MeshDistance&) = delete;

  MeshFoot Project(const Eigen::Vector3d& x_m) const;

  double Diagonal_m() const;  // of the box around the mesh
  const MeshMoments& Moments() const;
  // Number of edges whose two triangles have opposite orientations. Signs near them are undefined.
  int NumFlippedEdges() const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace velamap
