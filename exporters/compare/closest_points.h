// Poses of points on a surface by iterative closest points, which mesh_fit.cc uses.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "exporters/design/mesh_distance.h"
#include "importer/geometry/rigid3.h"

namespace velamap {

constexpr int kMaxFitIterations = 100;

struct PointResidual {
  Eigen::Vector3d x_m;        // the moved point
  Eigen::Vector3d direction;  // along which its distance grows
  double distance_m = 0.0;    // along `direction`
  bool is_over_surface = false;
};

// The distances of the points (m) from the mesh after `pose`, mesh_from_points. For a point beside
// the surface: its distance from the border.
std::vector<PointResidual> ComputeResiduals(const std::vector<Eigen::Vector3d>& points,
                                            const Rigid3& pose, const MeshDistance& mesh);

inline constexpr std::size_t kMinPointsOverSurface = 6;

// Whether at least `kMinPointsOverSurface` points lie over the surface.
bool EnoughOverSurface(const std::vector<PointResidual>& residuals);

// Tukey's biweights of the points over the surface, 0 for the others. Distances below `zero_m`
// count as zero.
std::vector<double> TukeyWeights(const std::vector<PointResidual>& residuals, double zero_m);

// A distance from this mesh that is due to rounding, m.
double ZeroDistance_m(const MeshDistance& mesh);

struct SurfacePose {
  Rigid3 pose;
  double trimmed_rms_m = 0.0;  // of the smallest 80 % of the squared distances
  bool has_converged = false;
  double last_step_m = 0.0;  // how far the last iteration moved the points at most
};

// Fits the points from several starts: the pose as it is and, unless `starts_as_is`, the 24
// rotations of their principal axes to those of the surface. Returns the best fits, the best first.
std::vector<SurfacePose> FitToSurface(const std::vector<Eigen::Vector3d>& points,
                                      const MeshDistance& mesh, bool starts_as_is);

}  // namespace velamap
