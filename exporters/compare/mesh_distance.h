// Signed distances of points to a triangle mesh.
//
// The nearest triangle comes from Open CASCADE's bounding volume hierarchy, the foot on it is
// exact. The sign is that of the angle-weighted normal at the foot (Baerentzen and Aanaes, "Signed
// distance computation using the angle weighted pseudonormal", IEEE TVCG 11(3), 2005), right also
// where the foot is on an edge or a vertex.

#pragma once

#include <memory>

#include <Eigen/Core>

#include "exporters/formats/mesh_triangles.h"

namespace velamap {

struct MeshFoot {
  Eigen::Vector3d x_m = Eigen::Vector3d::Zero();      // nearest point of the mesh
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // there, unit length
  // Distance, positive on the side to which the normal looks. Where the foot is on the mesh's
  // border: along the normal only, and the rest, within the tangent plane, is beside_m.
  double distance_m = 0.0;
  double beside_m = 0.0;

  // Whether the foot is a perpendicular's, to 1e-4 of the mesh's diagonal; otherwise the point lies
  // beside the surface, and no distance of it from the surface is defined.
  bool IsOverSurface(double diagonal_m) const { return beside_m <= 1e-4 * diagonal_m; }
};

// How the surface lies in space, by area.
struct MeshMoments {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
};

// Copies what it needs of the mesh. Vertices in one place, to 1e-8 of the mesh's extent, count as
// one: STL has no shared vertices, and the faces of CAD files share none.
class MeshDistance {
 public:
  // Needs a triangle with an area.
  explicit MeshDistance(const TriangleMesh& mesh);
  ~MeshDistance();
  MeshDistance(const MeshDistance&) = delete;
  MeshDistance& operator=(const MeshDistance&) = delete;

  MeshFoot Project(const Eigen::Vector3d& x_m) const;

  double Diagonal_m() const;  // of the box around the mesh
  const MeshMoments& Moments() const;
  // Edges whose two triangles look to opposite sides: signs near them mean nothing.
  int NumFlippedEdges() const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace velamap
