#include "exporters/part_planes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <fmt/format.h>

namespace velamap {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kParallelDeg = 10.0;

PartPlane FitPlane(const std::string& part, const std::vector<const ShapeMarker*>& markers) {
  std::vector<Eigen::Vector3d> corners;
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
  PartPlane plane;
  plane.part = part;
  plane.num_markers = static_cast<int>(markers.size());
  for (const ShapeMarker* marker : markers) {
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
      corners.push_back(*marker->x_in_shape_m[corner]);
      plane.centroid_m += corners.back();
    }
    facing += MarkerNormal(*marker);
  }
  plane.centroid_m /= static_cast<double>(corners.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : corners) {
    covariance += (x - plane.centroid_m) * (x - plane.centroid_m).transpose();
  }
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  if (plane.normal.dot(facing) < 0) plane.normal = -plane.normal;
  std::vector<double> residuals_mm;
  for (const Eigen::Vector3d& x : corners) {
    residuals_mm.push_back(1e3 * plane.normal.dot(x - plane.centroid_m));
  }
  plane.residual_mm = ComputeStatistics(std::move(residuals_mm));
  return plane;
}

}  // namespace

std::vector<PartPlane> FitPartPlanes(const MarkerShape& shape) {
  constexpr std::size_t kMinMarkers = 2;
  std::map<std::string, std::vector<const ShapeMarker*>> markers_of;
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.IsWhole()) markers_of[marker.part].push_back(&marker);
  }
  std::vector<PartPlane> planes;
  for (const auto& [part, markers] : markers_of) {
    if (markers.size() >= kMinMarkers) planes.push_back(FitPlane(part, markers));
  }
  return planes;
}

std::vector<PlanePair> ComparePlanes(const std::vector<PartPlane>& planes) {
  std::vector<PlanePair> pairs;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const PartPlane &a = planes[i], &b = planes[j];
      const double cosine = std::clamp(a.normal.dot(b.normal), -1.0, 1.0);
      PlanePair pair{a.part, b.part, std::acos(cosine) * 180 / kPi, 0.0};
      if (std::min(pair.angle_deg, 180 - pair.angle_deg) <= kParallelDeg) {
        const Eigen::Vector3d axis = (a.normal + (cosine < 0 ? -1.0 : 1.0) * b.normal).normalized();
        pair.distance_mm = 1e3 * std::abs(axis.dot(a.centroid_m - b.centroid_m));
      }
      pairs.push_back(pair);
    }
  }
  return pairs;
}

void PrintPlanes(const std::vector<PartPlane>& planes, std::ostream& out) {
  for (const PartPlane& plane : planes) {
    out << fmt::format("plane {}: {} markers, residual {:.4f} mm rms, {:.4f} mm max\n", plane.part,
                       plane.num_markers, plane.residual_mm.rms,
                       std::max(-plane.residual_mm.min, plane.residual_mm.max));
  }
  for (const PlanePair& pair : ComparePlanes(planes)) {
    out << fmt::format("planes {} and {}: {:.3f} degrees", pair.part1, pair.part2, pair.angle_deg);
    if (pair.distance_mm > 0) out << fmt::format(", {:.3f} mm apart", pair.distance_mm);
    out << '\n';
  }
}

}  // namespace velamap
