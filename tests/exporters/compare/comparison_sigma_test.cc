#include "exporters/compare/comparison_sigma.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/exporters/compare/example_comparison.h"

namespace velamap {
namespace {

AlignmentOptions BestFit() {
  AlignmentOptions options;
  options.method = AlignmentMethod::kBestFit;
  return options;
}

struct AlignedBoat {
  MarkerShape reference = BoatShape(0.002);
  MarkerShape shape = Moved(FarPose(), BoatShape(0.001));
  Alignment alignment = AlignShapes(shape, reference, BoatLayout(), BestFit());
  AlignmentSensitivity sensitivity{alignment};
  PointCovariance covariance = CovarianceFromSigmas(shape);
};

// The gradient of a place of the shape with respect to all corners, in the frame of the shape.
PointGradient WholeGradient(const AlignedBoat& boat, const Eigen::Vector3d& x_in_reference_m,
                            const Eigen::Vector3d& direction, CornerGradient own) {
  const auto motion = boat.sensitivity.MotionGradient(x_in_reference_m, direction);
  for (const auto& [corner, by_corner] : boat.sensitivity.MotionByCorner()) {
    const Eigen::Vector3d value = by_corner * motion;
    const auto [it, is_new] = own.emplace(corner, value);
    if (!is_new) it->second += value;
  }
  PointGradient gradient;
  for (const auto& [corner, value] : own) {
    gradient.emplace_back(Point3DIdFromCorner(corner),
                          boat.alignment.reference_from_shape.rotation.conjugate() * value);
  }
  return gradient;
}

TEST(ComparisonSigma, IsThatOfTheWholeGradient) {
  AlignedBoat boat;
  // Errors that all markers share.
  const Eigen::Index num_rows = boat.covariance.factor.rows();
  boat.covariance.factor.resize(num_rows, 2);
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    boat.covariance.factor.row(i) << 1e-3 * std::sin(0.3 * i), 5e-4 * std::cos(0.7 * i);
  }
  boat.covariance.signs = Eigen::Vector2d(1, -1);
  const AlignedNoise noise(boat.sensitivity, ComparedShape::kShape, boat.covariance);
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -0.5).normalized();
  for (const int id : {11, 34, 56, 122}) {
    const Eigen::Vector3d x_m = *FindWholeMarker(boat.reference, id)->x_in_shape_m[0];
    CornerGradient own;
    for (int corner = 1; corner <= kNumCorners; ++corner) own[{id, corner}] = direction / 4;
    const double expected_m2 =
        VarianceOf(boat.covariance, WholeGradient(boat, x_m, direction, own));
    EXPECT_NEAR(*noise.VarianceAt(x_m, direction, own), expected_m2, 1e-12 * expected_m2) << id;
    const Eigen::Matrix3d of_center_m2 = *noise.CenterCovariance({id, x_m});
    EXPECT_NEAR(direction.dot(of_center_m2 * direction), expected_m2, 1e-12 * expected_m2) << id;
  }
}

TEST(ComparisonSigma, WithoutACornerOfTheAlignmentThereIsNone) {
  AlignedBoat boat;
  boat.covariance = CovarianceFromSigmas(Without({56}, boat.shape));
  const AlignedNoise noise(boat.sensitivity, ComparedShape::kShape, boat.covariance);
  EXPECT_FALSE(noise.CenterCovariance({11, Eigen::Vector3d::Zero()}));
  EXPECT_FALSE(noise.VarianceAt(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), {}));
}

// The errors of all corners together are those of the motion, which the alignment takes back.
TEST(ComparisonSigma, MotionByCornersUndoesAMotionOfAllCorners) {
  const AlignedBoat boat;
  const Eigen::Vector3d shift(0.01, -0.02, 0.03);
  AlignmentSensitivity::Vector6d motion = AlignmentSensitivity::Vector6d::Zero();
  for (const auto& [corner, by_corner] : boat.sensitivity.MotionByCorner()) {
    motion += by_corner.transpose() * shift;
  }
  EXPECT_LT(motion.head<3>().norm(), 1e-12);
  EXPECT_LT((motion.tail<3>() + shift).norm(), 1e-12);
}

}  // namespace
}  // namespace velamap
