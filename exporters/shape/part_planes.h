// Flatness of the parts of a shape, and angles and distances between them (thesis sections 4.1 and
// 4.2).

#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/base/statistics.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// The least-squares plane of all corners of a part's whole markers, and the deviations of the
// markers from it. Shape frame, m.
struct PartPlane {
  std::string part;
  int num_markers = 0;
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal =
      Eigen::Vector3d::UnitZ();   // unit, towards the side that the markers face
  Statistics corner_distance_mm;  // of the corners, without sign
  // Plane projected error of thesis section 4.1: unsigned distances of the centres from the plane
  // of the centres. Empty with fewer than four markers, because three centres always lie in a
  // plane.
  Statistics center_distance_mm;
  // Orientation error of thesis section 4.1: angles between each marker's vector and their mean.
  Statistics normal_spread_deg;
  Statistics tangent_spread_deg;  // of the x axes; shows markers that are rotated in the plane
  // The part of center_distance_mm.rms that the uncertainty of the corners explains.
  std::optional<double> center_distance_sigma_mm;
  std::vector<std::pair<Point3DId, Eigen::Vector3d>> corners_m;  // of the fit
};

struct PlanePair {
  std::string part1, part2;
  double angle_deg = 0.0;  // between the outward normals, 0..180
  // Distance of the centroids along the mean normal, for planes within 10 degrees of parallel; 0
  // otherwise.
  double distance_mm = 0.0;
  // Near 0 and 180 degrees, where the angle can deviate to one side only, the sigma of the tilt.
  std::optional<double> angle_sigma_deg;
  std::optional<double> distance_sigma_mm;
};

// Fits one plane per part with at least two whole markers, sorted by name. Sigmas are known if
// `covariance`, of the corners of the shape, has all corners that they depend on.
std::vector<PartPlane> FitPartPlanes(const MarkerShape& shape,
                                     const PointCovariance* covariance = nullptr);

// Compares all pairs of planes, in order.
std::vector<PlanePair> ComparePlanes(const std::vector<PartPlane>& planes,
                                     const PointCovariance* covariance = nullptr);

}  // namespace velamap
