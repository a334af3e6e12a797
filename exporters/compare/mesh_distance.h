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

namespace velamap {

struct MeshFoot {
  Eigen::Vector3d x_m = Eigen::Vector3d::Zero();      // nearest point of the mesh
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // at x_m, unit length
  // Distance, positive on the side to which the normal points. If the foot is on the border of the
  // mesh, the distance along the normal; beside_m is the distance within the tangent plane.
  double distance_m = 0.0;
  double beside_m = 0.0;

  // Whether the line to the foot is along the normal, to 1e-4 of the mesh's diagonal. Otherwise the
  // point lies beside the surface and has no distance from it.
  bool IsOverSurface(double diagonal_m) const { return beside_m <= 1e-4 * diagonal_m; }
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
  // Needs a triangle with a positive area.
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
