#include "exporters/compare/comparison_sigma.h"

#include <algorithm>
#include <cmath>

#include "exporters/shape/joint_covariance.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/geometry/symmetric_eigen.h"
#include "reconstruct/geometry/covariance_update.h"

namespace velamap {
namespace {

// Motions with a smaller eigenvalue, relative to the largest one, count as undetermined.
constexpr double kMinEigenvalueRatio = 1e-9;

// Covariance of the corners that have a sigma, in order; 3c x 3c.
Eigen::MatrixXd MarkerBlock(const ShapeMarker& marker, const std::vector<int>& corners) {
  const auto num_corners = static_cast<Eigen::Index>(corners.size());
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3 * num_corners, 3 * num_corners);
  const auto variance = [&](int corner, int axis) {
    return std::pow((*marker.sigma_m[static_cast<std::size_t>(corner)])[axis], 2);
  };
  const bool has_center = num_corners == kNumCorners && marker.sigma_m[0].has_value();
  for (int axis = 0; axis < 3; ++axis) {
    double mean = 0.0;
    for (const int corner : corners) mean += variance(corner, axis) / num_corners;
    // The sigma of the centre gives the common part.
    const double common = has_center ? variance(0, axis) : 0.0;
    const double own = OwnVarianceOfCorners(mean, common);
    for (Eigen::Index i = 0; i < num_corners; ++i) {
      for (Eigen::Index j = 0; j < num_corners; ++j) {
        double& entry = block(3 * i + axis, 3 * j + axis);
        if (has_center) {
          entry = common + own * ((i == j ? 1.0 : 0.0) - 1.0 / kNumCorners);
        } else if (i == j) {
          entry = variance(corners[static_cast<std::size_t>(i)], axis);
        }
      }
    }
  }
  return block;
}

}  // namespace

PointCovariance CovarianceFromSigmas(const MarkerShape& shape) {
  PointCovariance covariance;
  for (const ShapeMarker& marker : shape.markers) {
    std::vector<int> corners;
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const auto idx = static_cast<std::size_t>(corner);
      if (marker.x_in_shape_m[idx] && marker.sigma_m[idx]) corners.push_back(corner);
    }
    if (corners.empty()) continue;
    for (const int corner : corners) {
      covariance.point3D_ids.push_back(Point3DIdFromCorner({marker.marker_id, corner}));
    }
    covariance.blocks.push_back(MarkerBlock(marker, corners));
  }
  covariance.factor.setZero(3 * static_cast<Eigen::Index>(covariance.point3D_ids.size()), 0);
  return covariance;
}

AlignmentSensitivity::AlignmentSensitivity(const Alignment& alignment) : alignment_(alignment) {
  const auto& equations = alignment.equations;
  if (equations.empty()) return;
  for (const AlignmentEquation& equation : equations) {
    center_ += equation.x_in_reference_m / static_cast<double>(equations.size());
  }
  double sum = 0.0;
  for (const AlignmentEquation& equation : equations) {
    sum += (equation.x_in_reference_m - center_).squaredNorm();
  }
  radius_m_ = std::max(std::sqrt(sum / static_cast<double>(equations.size())), 1e-12);
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  for (const AlignmentEquation& equation : equations) {
    const Vector6d row = MotionGradient(equation.x_in_reference_m, equation.direction);
    normal += equation.weight * row * row.transpose();
  }
  const SymmetricEigen eigen = DecomposeSymmetric(normal);
  const double largest = eigen.values[5];
  for (int i = 0; i < 6; ++i) {
    const double value = eigen.values[i];
    if (value <= kMinEigenvalueRatio * largest) {
      ++num_free_directions_;
      continue;
    }
    const Vector6d motion = eigen.vectors.col(i);
    inverse_normal_ += motion * motion.transpose() / value;
  }
}

AlignmentSensitivity::Vector6d AlignmentSensitivity::MotionGradient(
    const Eigen::Vector3d& x_in_reference_m, const Eigen::Vector3d& direction) const {
  Vector6d gradient;
  gradient << (x_in_reference_m - center_).cross(direction) / radius_m_, direction;
  return gradient;
}

std::map<CornerId, Eigen::Matrix<double, 3, 6>> AlignmentSensitivity::MotionByCorner() const {
  std::map<CornerId, Eigen::Matrix<double, 3, 6>> by_corner;
  for (const AlignmentEquation& equation : alignment_.equations) {
    const Vector6d row = MotionGradient(equation.x_in_reference_m, equation.direction);
    const Eigen::Matrix<double, 3, 6> part =
        -equation.weight * equation.direction * (inverse_normal_ * row).transpose();
    const auto [it, is_new] = by_corner.emplace(equation.corner, part);
    if (!is_new) it->second += part;
  }
  return by_corner;
}

AlignedNoise::AlignedNoise(const AlignmentSensitivity& sensitivity, ComparedShape whose,
                           const PointCovariance& covariance)
    : sensitivity_(sensitivity),
      covariance_(covariance),
      own_from_reference_(whose == ComparedShape::kShape
                              ? sensitivity.ReferenceFromShape().rotation.conjugate()
                              : Eigen::Quaterniond::Identity()) {
  const Eigen::Matrix3d rotation = own_from_reference_.toRotationMatrix();
  Eigen::MatrixXd motion_by_rows = Eigen::MatrixXd::Zero(covariance.factor.rows(), 6);
  for (const auto& [corner, motion] : sensitivity.MotionByCorner()) {
    const int idx = covariance.IndexOf(Point3DIdFromCorner(corner));
    has_all_corners_ = has_all_corners_ && idx >= 0;
    if (idx >= 0) motion_by_rows.middleRows<3>(3 * idx) = rotation * motion;
  }
  if (!has_all_corners_) return;
  corners_with_motion_ = Multiply(covariance, motion_by_rows);
  of_motion_ = motion_by_rows.transpose() * corners_with_motion_;
}

std::optional<Eigen::MatrixXd> AlignedNoise::CovarianceOfPlaces(
    const std::vector<CornerGradient>& own, const Eigen::MatrixXd& by_motion) const {
  if (!has_all_corners_) return std::nullopt;
  std::vector<PointGradient> rotated(own.size());
  Eigen::MatrixXd own_with_motion = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(own.size()), 6);
  for (std::size_t i = 0; i < own.size(); ++i) {
    for (const auto& [corner, value] : own[i]) {
      const Point3DId point3D_id = Point3DIdFromCorner(corner);
      const int idx = covariance_.IndexOf(point3D_id);
      if (idx < 0) return std::nullopt;
      rotated[i].emplace_back(point3D_id, own_from_reference_ * value);
      own_with_motion.row(static_cast<Eigen::Index>(i)) +=
          rotated[i].back().second.transpose() * corners_with_motion_.middleRows<3>(3 * idx);
    }
  }
  const Eigen::MatrixXd both = own_with_motion * by_motion;
  return Eigen::MatrixXd(JointCovarianceOf(covariance_, rotated) + both + both.transpose() +
                         by_motion.transpose() * of_motion_ * by_motion);
}

std::optional<double> AlignedNoise::VarianceAt(const Eigen::Vector3d& x_in_reference_m,
                                               const Eigen::Vector3d& direction,
                                               const CornerGradient& own) const {
  const auto covariance_m2 =
      CovarianceOfPlaces({own}, sensitivity_.MotionGradient(x_in_reference_m, direction));
  if (!covariance_m2) return std::nullopt;
  return std::max(0.0, (*covariance_m2)(0, 0));  // rounding can make it negative
}

std::optional<Eigen::Matrix3d> AlignedNoise::CenterCovariance(
    const MarkerInReference& marker) const {
  std::vector<CornerGradient> own(3);
  Eigen::MatrixXd by_motion(6, 3);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      own[static_cast<std::size_t>(axis)][{marker.marker_id, corner}] = direction / kNumCorners;
    }
    by_motion.col(axis) = sensitivity_.MotionGradient(marker.center_in_reference_m, direction);
  }
  const auto covariance_m2 = CovarianceOfPlaces(own, by_motion);
  if (!covariance_m2) return std::nullopt;
  return Eigen::Matrix3d(*covariance_m2);
}

std::optional<Eigen::Matrix3d> DifferenceCovariance(const MarkerInReference& marker,
                                                    const AlignedNoise& shape,
                                                    const AlignedNoise* reference) {
  const auto of_shape = shape.CenterCovariance(marker);
  if (!of_shape || reference == nullptr) return of_shape;
  const auto of_reference = reference->CenterCovariance(marker);
  if (!of_reference) return std::nullopt;
  return Eigen::Matrix3d(*of_shape + *of_reference);
}

}  // namespace velamap
