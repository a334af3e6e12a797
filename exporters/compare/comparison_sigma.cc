#include "exporters/compare/comparison_sigma.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "exporters/shape/joint_covariance.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/geometry/symmetric_eigen.h"

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

void AlignmentSensitivity::AddAlignment(const Eigen::Vector3d& x_in_reference_m,
                                        const Eigen::Vector3d& direction,
                                        CornerGradient* gradient) const {
  const Vector6d by_motion = inverse_normal_ * MotionGradient(x_in_reference_m, direction);
  for (const AlignmentEquation& equation : alignment_.equations) {
    const Vector6d row = MotionGradient(equation.x_in_reference_m, equation.direction);
    const Eigen::Vector3d part = -equation.weight * by_motion.dot(row) * equation.direction;
    const auto [it, is_new] = gradient->emplace(equation.corner, part);
    if (!is_new) it->second += part;
  }
}

PointGradient AlignmentSensitivity::InFrameOf(ComparedShape whose,
                                              const CornerGradient& gradient) const {
  const Eigen::Quaterniond target_from_reference =
      whose == ComparedShape::kShape ? alignment_.reference_from_shape.rotation.conjugate()
                                     : Eigen::Quaterniond::Identity();
  PointGradient rotated;
  for (const auto& [corner, value] : gradient) {
    rotated.emplace_back(Point3DIdFromCorner(corner), target_from_reference * value);
  }
  return rotated;
}

std::optional<double> AlignmentSensitivity::VarianceAt(const Eigen::Vector3d& x_in_reference_m,
                                                       const Eigen::Vector3d& direction,
                                                       CornerGradient own, ComparedShape whose,
                                                       const PointCovariance& covariance) const {
  AddAlignment(x_in_reference_m, direction, &own);
  const PointGradient gradient = InFrameOf(whose, own);
  if (!HasPointsOf(gradient, &covariance)) return std::nullopt;
  return VarianceOf(covariance, gradient);
}

std::optional<Eigen::Matrix3d> AlignmentSensitivity::CenterCovariance(
    const MarkerInReference& marker, ComparedShape whose, const PointCovariance& covariance) const {
  std::vector<PointGradient> gradients;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
    CornerGradient gradient;
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      gradient[{marker.marker_id, corner}] = direction / kNumCorners;
    }
    AddAlignment(marker.center_in_reference_m, direction, &gradient);
    gradients.push_back(InFrameOf(whose, gradient));
    if (!HasPointsOf(gradients.back(), &covariance)) return std::nullopt;
  }
  return Eigen::Matrix3d(JointCovarianceOf(covariance, gradients));
}

std::optional<Eigen::Matrix3d> AlignmentSensitivity::DifferenceCovariance(
    const MarkerInReference& marker, const PointCovariance& shape,
    const PointCovariance* reference) const {
  const auto of_shape = CenterCovariance(marker, ComparedShape::kShape, shape);
  if (!of_shape || reference == nullptr) return of_shape;
  const auto of_reference = CenterCovariance(marker, ComparedShape::kReference, *reference);
  if (!of_reference) return std::nullopt;
  return Eigen::Matrix3d(*of_shape + *of_reference);
}

}  // namespace velamap
