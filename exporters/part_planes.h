// How flat the parts of a shape are, and how they stand to each other (thesis sections 4.1, 4.2).

#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/marker_shape.h"
#include "reconstruct/statistics.h"

namespace velamap {

// Least-squares plane of all corners of a part's whole markers. Shape frame, m.
struct PartPlane {
  std::string part;
  int num_markers = 0;
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, on the side that the markers face
  Statistics residual_mm;                             // signed distances of the corners
};

struct PlanePair {
  std::string part1, part2;
  double angle_deg = 0.0;  // between the outward normals, 0..180
  // Distance of the centroids along the mean normal axis, for planes within 10 degrees of parallel;
  // 0 otherwise.
  double distance_mm = 0.0;
};

// One plane a part with at least two whole markers, by name.
std::vector<PartPlane> FitPartPlanes(const MarkerShape& shape);

// All pairs of planes in order.
std::vector<PlanePair> ComparePlanes(const std::vector<PartPlane>& planes);

// `key: value` lines: residuals of every part, angle and distance of every pair.
void PrintPlanes(const std::vector<PartPlane>& planes, std::ostream& out);

}  // namespace velamap
