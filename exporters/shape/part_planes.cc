#include "exporters/shape/part_planes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "exporters/shape/joint_covariance.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/geometry/directions.h"
#include "importer/geometry/principal_axes.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kParallelDeg = 10.0;

Eigen::Vector3d NormalOf(const PrincipalAxes& plane) { return plane.directions.col(0); }

std::vector<Eigen::Vector3d> PositionsOf(const PartPlane& plane) {
  std::vector<Eigen::Vector3d> positions;
  for (const auto& [point3D_id, x] : plane.corners_m) positions.push_back(x);
  return positions;
}

// Adds the gradient of `weight` . normal with respect to the corners. To first order, the normal
// turns towards each other axis by the change of the scatter between the two over the difference of
// their sums of squares.
void AddNormalGradient(const PartPlane& part_plane, const Eigen::Vector3d& weight,
                       PointGradient* gradient) {
  const PrincipalAxes plane = ComputePrincipalAxes(PositionsOf(part_plane));
  const Eigen::Vector3d& normal = part_plane.normal;
  for (const auto& [point3D_id, x] : part_plane.corners_m) {
    const Eigen::Vector3d from_centroid = x - plane.mean;
    Eigen::Vector3d by_point = Eigen::Vector3d::Zero();
    for (int i = 1; i < 3; ++i) {
      const Eigen::Vector3d axis = plane.directions.col(i);
      by_point += weight.dot(axis) / (plane.sums_of_squares[0] - plane.sums_of_squares[i]) *
                  (normal.dot(from_centroid) * axis + axis.dot(from_centroid) * normal);
    }
    gradient->emplace_back(point3D_id, by_point);
  }
}

void AddCentroidGradient(const PartPlane& plane, const Eigen::Vector3d& weight,
                         PointGradient* gradient) {
  const double num_points = static_cast<double>(plane.corners_m.size());
  for (const auto& [point3D_id, x] : plane.corners_m) {
    gradient->emplace_back(point3D_id, weight / num_points);
  }
}

// Root of the mean variance of the distances of the centres from their own plane, to first order.
// The plane absorbs displacements along the normal that are linear in the plane.
std::optional<double> CenterDistanceSigma(const std::vector<int>& marker_ids,
                                          const std::vector<Eigen::Vector3d>& centers,
                                          const PointCovariance* covariance) {
  if (covariance == nullptr) return std::nullopt;
  const PrincipalAxes plane = ComputePrincipalAxes(centers);
  const auto num_centers = static_cast<Eigen::Index>(centers.size());
  Eigen::MatrixXd linear(num_centers, 3);
  std::vector<PointGradient> gradients(centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i) {
    linear.row(i) << 1, (centers[i] - plane.mean).transpose() * plane.directions.rightCols<2>();
    AddPointGradient(marker_ids[i], 0, NormalOf(plane), &gradients[i]);
    if (!SigmaOf(covariance, gradients[i])) return std::nullopt;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(linear);
  const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(num_centers, 3);
  const Eigen::MatrixXd joint = JointCovarianceOf(*covariance, gradients);
  const double variance = joint.trace() - (basis.transpose() * joint * basis).trace();
  return std::sqrt(std::max(0.0, variance) / static_cast<double>(num_centers));
}

Statistics DistancesMm(const std::vector<Eigen::Vector3d>& points, const PrincipalAxes& plane) {
  std::vector<double> distances_mm;
  for (const Eigen::Vector3d& x : points) {
    distances_mm.push_back(kMmPerM * std::abs(NormalOf(plane).dot(x - plane.mean)));
  }
  return ComputeStatistics(std::move(distances_mm));
}

Statistics SpreadDeg(const std::vector<Eigen::Vector3d>& directions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : directions) mean += direction;
  std::vector<double> angles_deg;
  for (const Eigen::Vector3d& direction : directions)
    angles_deg.push_back(kDegPerRad * AngleBetween(direction, mean));
  return ComputeStatistics(std::move(angles_deg));
}

bool IsNearlyParallel(const PlanePair& pair) {
  return std::min(pair.angle_deg, 180 - pair.angle_deg) <= kParallelDeg;
}

PartPlane PlaneOfPart(const std::string& part, const std::vector<const ShapeMarker*>& markers,
                      const PointCovariance* covariance) {
  constexpr std::size_t kMinCenters = 4;
  PartPlane result;
  std::vector<int> marker_ids;
  std::vector<Eigen::Vector3d> centers, normals, tangents;
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
  for (const ShapeMarker* marker : markers) {
    const auto& x = marker->x_in_shape_m;
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      result.corners_m.emplace_back(Point3DIdFromCorner({marker->marker_id, corner}), *x[corner]);
    }
    marker_ids.push_back(marker->marker_id);
    centers.push_back(*x[0]);
    normals.push_back(MarkerNormal(*marker));
    tangents.push_back((*x[2] - *x[1] + *x[3] - *x[4]).stableNormalized());
    facing += normals.back();
  }
  const std::vector<Eigen::Vector3d> corners = PositionsOf(result);
  const PrincipalAxes plane = ComputePrincipalAxes(corners);
  result.part = part;
  result.num_markers = static_cast<int>(markers.size());
  result.centroid_m = plane.mean;
  result.normal =
      NormalOf(plane).dot(facing) < 0 ? Eigen::Vector3d(-NormalOf(plane)) : NormalOf(plane);
  result.corner_distance_mm = DistancesMm(corners, plane);
  if (centers.size() >= kMinCenters) {
    result.center_distance_mm = DistancesMm(centers, ComputePrincipalAxes(centers));
    const auto sigma_m = CenterDistanceSigma(marker_ids, centers, covariance);
    if (sigma_m) result.center_distance_sigma_mm = kMmPerM * *sigma_m;
  }
  result.normal_spread_deg = SpreadDeg(normals);
  result.tangent_spread_deg = SpreadDeg(tangents);
  return result;
}

// Unit vector orthogonal to `normal` towards `other`; an arbitrary one if both are parallel.
Eigen::Vector3d Towards(const Eigen::Vector3d& normal, const Eigen::Vector3d& other) {
  constexpr double kParallel = 1e-9;
  const Eigen::Vector3d across = other - normal.dot(other) * normal;
  return across.norm() > kParallel ? Eigen::Vector3d(across.normalized()) : normal.unitOrthogonal();
}

void AddSigmas(const PartPlane& a, const PartPlane& b, const PointCovariance* covariance,
               PlanePair* pair) {
  if (covariance == nullptr) return;
  PointGradient by_angle;
  const Eigen::Vector3d a_to_b = Towards(a.normal, b.normal);
  // Both normals turn about one axis, which `a` defines where they are parallel.
  const Eigen::Vector3d axis = a.normal.cross(a_to_b);
  AddNormalGradient(a, -a_to_b, &by_angle);
  AddNormalGradient(b, axis.cross(b.normal), &by_angle);
  const std::optional<double> angle_sigma_rad = SigmaOf(covariance, by_angle);
  if (angle_sigma_rad) pair->angle_sigma_deg = *angle_sigma_rad * kDegPerRad;
  if (!IsNearlyParallel(*pair)) return;

  const double sign = pair->angle_deg > 90 ? -1.0 : 1.0;
  const Eigen::Vector3d sum = a.normal + sign * b.normal;
  const Eigen::Vector3d mean_normal = sum.normalized();
  const Eigen::Vector3d difference = a.centroid_m - b.centroid_m;
  const Eigen::Vector3d by_normal =
      (difference - difference.dot(mean_normal) * mean_normal) / sum.norm();
  PointGradient by_distance;
  AddCentroidGradient(a, mean_normal, &by_distance);
  AddCentroidGradient(b, -mean_normal, &by_distance);
  AddNormalGradient(a, by_normal, &by_distance);
  AddNormalGradient(b, sign * by_normal, &by_distance);
  const std::optional<double> distance_sigma_m = SigmaOf(covariance, by_distance);
  if (distance_sigma_m) pair->distance_sigma_mm = kMmPerM * *distance_sigma_m;
}

}  // namespace

std::vector<PartPlane> FitPartPlanes(const MarkerShape& shape, const PointCovariance* covariance) {
  constexpr std::size_t kMinMarkers = 2;
  std::map<std::string, std::vector<const ShapeMarker*>> markers_of;
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.IsWhole()) markers_of[marker.part].push_back(&marker);
  }
  std::vector<PartPlane> planes;
  for (const auto& [part, markers] : markers_of) {
    if (markers.size() >= kMinMarkers) {
      planes.push_back(PlaneOfPart(part, markers, covariance));
    }
  }
  return planes;
}

std::vector<PlanePair> ComparePlanes(const std::vector<PartPlane>& planes,
                                     const PointCovariance* covariance) {
  std::vector<PlanePair> pairs;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const PartPlane &a = planes[i], &b = planes[j];
      PlanePair pair;
      pair.part1 = a.part;
      pair.part2 = b.part;
      pair.angle_deg = kDegPerRad * AngleBetween(a.normal, b.normal);
      if (IsNearlyParallel(pair)) {
        const Eigen::Vector3d axis =
            (a.normal + (pair.angle_deg > 90 ? -1.0 : 1.0) * b.normal).normalized();
        pair.distance_mm = kMmPerM * std::abs(axis.dot(a.centroid_m - b.centroid_m));
      }
      AddSigmas(a, b, covariance, &pair);
      pairs.push_back(pair);
    }
  }
  return pairs;
}

}  // namespace velamap
