// How flat the parts of a shape are, and how they stand to each other (thesis sections 4.1, 4.2).

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

// The least-squares plane of all corners of a part's whole markers, and how far the markers are
// from lying in it. Shape frame, m.
struct PartPlane {
  std::string part;
  int num_markers = 0;
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, on the side that the markers face
  Statistics corner_distance_mm;                      // of the corners, without sign
  // Thesis 4.1, plane projected error: distances of the centres, without sign, from the plane of
  // the centres. No value with fewer than four, which always have one.
  Statistics center_distance_mm;
  // Thesis 4.1, orientation error: angles between each marker's vector and the mean of all of them.
  Statistics normal_spread_deg;
  Statistics tangent_spread_deg;  // of the x axes: marks markers that are turned in the plane
  // What the corners' uncertainty alone makes of center_distance_mm.rms.
  std::optional<double> center_distance_sigma_mm;
  std::vector<std::pair<Point3DId, Eigen::Vector3d>> corners_m;  // that the plane is fitted to
};

struct PlanePair {
  std::string part1, part2;
  double angle_deg = 0.0;  // between the outward normals, 0..180
  // Distance of the centroids along the mean normal axis, for planes within 10 degrees of parallel;
  // 0 otherwise.
  double distance_mm = 0.0;
  // Near 0 and 180 degrees, where the angle can err to one side only, that of the tilt along it.
  std::optional<double> angle_sigma_deg;
  std::optional<double> distance_sigma_mm;
};

// One plane a part with at least two whole markers, by name. Sigmas are there where `covariance`,
// of the shape's corners, is given and holds all that they depend on.
std::vector<PartPlane> FitPartPlanes(const MarkerShape& shape,
                                     const PointCovariance* covariance = nullptr);

// All pairs of planes in order.
std::vector<PlanePair> ComparePlanes(const std::vector<PartPlane>& planes,
                                     const PointCovariance* covariance = nullptr);

}  // namespace velamap
