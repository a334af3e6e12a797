#include "exporters/part_planes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace velamap {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kParallelDeg = 10.0;

struct Plane {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal;
};

Plane FitPlane(const std::vector<Eigen::Vector3d>& points) {
  Plane plane;
  for (const Eigen::Vector3d& x : points) plane.centroid += x;
  plane.centroid /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points) {
    scatter += (x - plane.centroid) * (x - plane.centroid).transpose();
  }
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  return plane;
}

Statistics DistancesMm(const std::vector<Eigen::Vector3d>& points, const Plane& plane) {
  std::vector<double> distances_mm;
  for (const Eigen::Vector3d& x : points) {
    distances_mm.push_back(1e3 * std::abs(plane.normal.dot(x - plane.centroid)));
  }
  return ComputeStatistics(std::move(distances_mm));
}

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  // Exact for small angles too, where the arc cosine is not.
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / kPi;
}

Statistics SpreadDeg(const std::vector<Eigen::Vector3d>& directions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : directions) mean += direction;
  std::vector<double> angles_deg;
  for (const Eigen::Vector3d& direction : directions)
    angles_deg.push_back(AngleDeg(direction, mean));
  return ComputeStatistics(std::move(angles_deg));
}

PartPlane PlaneOfPart(const std::string& part, const std::vector<const ShapeMarker*>& markers) {
  constexpr std::size_t kMinCenters = 4;
  std::vector<Eigen::Vector3d> corners, centers, normals, tangents;
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
  for (const ShapeMarker* marker : markers) {
    const auto& x = marker->x_in_shape_m;
    for (std::size_t corner = 1; corner <= kNumCorners; ++corner) corners.push_back(*x[corner]);
    centers.push_back(*x[0]);
    normals.push_back(MarkerNormal(*marker));
    tangents.push_back((*x[2] - *x[1] + *x[3] - *x[4]).stableNormalized());
    facing += normals.back();
  }
  Plane plane = FitPlane(corners);
  if (plane.normal.dot(facing) < 0) plane.normal = -plane.normal;
  PartPlane result;
  result.part = part;
  result.num_markers = static_cast<int>(markers.size());
  result.centroid_m = plane.centroid;
  result.normal = plane.normal;
  result.corner_distance_mm = DistancesMm(corners, plane);
  if (centers.size() >= kMinCenters) {
    result.center_distance_mm = DistancesMm(centers, FitPlane(centers));
  }
  result.normal_spread_deg = SpreadDeg(normals);
  result.tangent_spread_deg = SpreadDeg(tangents);
  return result;
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
    if (markers.size() >= kMinMarkers) planes.push_back(PlaneOfPart(part, markers));
  }
  return planes;
}

std::vector<PlanePair> ComparePlanes(const std::vector<PartPlane>& planes) {
  std::vector<PlanePair> pairs;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const PartPlane &a = planes[i], &b = planes[j];
      PlanePair pair{a.part, b.part, AngleDeg(a.normal, b.normal), 0.0};
      if (std::min(pair.angle_deg, 180 - pair.angle_deg) <= kParallelDeg) {
        const Eigen::Vector3d axis =
            (a.normal + (pair.angle_deg > 90 ? -1.0 : 1.0) * b.normal).normalized();
        pair.distance_mm = 1e3 * std::abs(axis.dot(a.centroid_m - b.centroid_m));
      }
      pairs.push_back(pair);
    }
  }
  return pairs;
}

}  // namespace velamap
