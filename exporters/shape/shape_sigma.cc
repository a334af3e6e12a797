#include "exporters/shape/shape_sigma.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "importer/base/statistics.h"
#include "importer/geometry/units.h"

namespace velamap {

void AddPointGradient(int marker_id, int corner, const Eigen::Vector3d& weight,
                      PointGradient* gradient) {
  if (corner > 0) {
    gradient->emplace_back(Point3DIdFromCorner({marker_id, corner}), weight);
    return;
  }
  for (int each = 1; each <= kNumCorners; ++each) {
    AddPointGradient(marker_id, each, weight / kNumCorners, gradient);
  }
}

double OwnVarianceOfCorners(double mean_of_corners_m2, double of_center_m2) {
  return std::max(0.0, mean_of_corners_m2 - of_center_m2) * 4.0 / 3.0;
}

PointGradient DistanceGradient(const ShapeMarker& marker1, int corner1, const ShapeMarker& marker2,
                               int corner2) {
  const Eigen::Vector3d difference =
      marker1.x_in_shape_m[corner1].value() - marker2.x_in_shape_m[corner2].value();
  PointGradient gradient;
  if (difference.norm() == 0) return gradient;
  const Eigen::Vector3d direction = difference.normalized();
  AddPointGradient(marker1.marker_id, corner1, direction, &gradient);
  AddPointGradient(marker2.marker_id, corner2, -direction, &gradient);
  return gradient;
}

PointGradient SideGradient(const ShapeMarker& marker, int side) {
  return DistanceGradient(marker, side, marker, side % kNumCorners + 1);
}

PointGradient MeanSideGradient(const ShapeMarker& marker) {
  PointGradient gradient;
  for (int side = 1; side <= kNumCorners; ++side) {
    for (const auto& [point3D_id, weight] : SideGradient(marker, side)) {
      gradient.emplace_back(point3D_id, weight / kNumCorners);
    }
  }
  return gradient;
}

PointGradient AreaGradient(const ShapeMarker& marker) {
  // The area is n . (d42 x d31) / 2 with d42 = x2 - x4 and d31 = x1 - x3. To first order it does
  // not depend on the direction of the normal n.
  const Eigen::Vector3d normal = MarkerNormal(marker);
  const auto& x = marker.x_in_shape_m;
  const Eigen::Vector3d by_x2 = 0.5 * (*x[1] - *x[3]).cross(normal);
  const Eigen::Vector3d by_x1 = 0.5 * normal.cross(*x[2] - *x[4]);
  PointGradient gradient;
  AddPointGradient(marker.marker_id, 1, by_x1, &gradient);
  AddPointGradient(marker.marker_id, 2, by_x2, &gradient);
  AddPointGradient(marker.marker_id, 3, -by_x1, &gradient);
  AddPointGradient(marker.marker_id, 4, -by_x2, &gradient);
  return gradient;
}

bool HasPointsOf(const PointGradient& gradient, const PointCovariance* covariance) {
  return covariance != nullptr &&
         std::all_of(gradient.begin(), gradient.end(),
                     [&](const auto& entry) { return covariance->IndexOf(entry.first) >= 0; });
}

std::optional<double> SigmaOf(const PointCovariance* covariance, const PointGradient& gradient) {
  if (gradient.empty() || !HasPointsOf(gradient, covariance)) return std::nullopt;
  return std::sqrt(VarianceOf(*covariance, gradient));
}

double NominalSigma(const Eigen::Matrix3Xd& points_in_shape_m) {
  constexpr double kOfDiagonal = 3e-5;
  const Eigen::Vector3d diagonal =
      points_in_shape_m.rowwise().maxCoeff() - points_in_shape_m.rowwise().minCoeff();
  return kOfDiagonal * diagonal.norm();
}

std::optional<Eigen::Vector3d> PointSigma(const PointCovariance* covariance, int marker_id,
                                          int corner) {
  Eigen::Vector3d sigma_m;
  for (int axis = 0; axis < 3; ++axis) {
    PointGradient gradient;
    AddPointGradient(marker_id, corner, Eigen::Vector3d::Unit(axis), &gradient);
    const std::optional<double> sigma = SigmaOf(covariance, gradient);
    if (!sigma) return std::nullopt;
    sigma_m[axis] = *sigma;
  }
  return sigma_m;
}

std::optional<PointCovariance> WithoutSharedErrors(const PointCovariance* covariance) {
  if (covariance == nullptr) return std::nullopt;
  PointCovariance own = *covariance;
  own.factor.setZero(own.factor.rows(), 0);
  own.signs.resize(0);
  return own;
}

std::map<int, double> CenterSigmas_mm(const PointCovariance& covariance) {
  std::map<int, double> sigmas_mm;
  for (const Point3DId point3D_id : covariance.point3D_ids) {
    const int marker_id = CornerFromPoint3DId(point3D_id).marker_id;
    if (sigmas_mm.count(marker_id) > 0) continue;
    const auto sigma_m = PointSigma(&covariance, marker_id, 0);
    if (sigma_m) sigmas_mm[marker_id] = kMmPerM * sigma_m->norm();
  }
  return sigmas_mm;
}

double MedianSigma(const std::map<int, double>& sigma_by_marker) {
  std::vector<double> sigmas;
  for (const auto& [marker_id, sigma] : sigma_by_marker) sigmas.push_back(sigma);
  return Median(std::move(sigmas));
}

}  // namespace velamap
