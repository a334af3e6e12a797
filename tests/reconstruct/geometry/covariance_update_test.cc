#include "reconstruct/geometry/covariance_update.h"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tests/reconstruct/dense_covariance.h"

namespace velamap {
namespace {

// Covariance of three markers with 4, 1 and 3 corners.
class Covariances : public testing::Test {
 protected:
  Covariances() {
    points_.point3D_ids = {11, 12, 13, 14, 22, 31, 32, 34};
    for (const int size : {12, 3, 9}) {
      const Eigen::MatrixXd root = Random(size, size);
      points_.blocks.push_back(root * root.transpose());
    }
    points_.factor = Random(24, 5);
    points_.signs = Eigen::VectorXd::Ones(5);
    for (int i = 0; i < 8; ++i) x_in_world_.push_back(Random(3, 1));
  }

  Eigen::MatrixXd Random(int rows, int cols) {
    std::normal_distribution<double> normal;
    Eigen::MatrixXd matrix(rows, cols);
    for (double& value : matrix.reshaped()) value = normal(random_);
    return matrix;
  }

  static double RelativeError(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / b.norm();
  }

  std::mt19937 random_{1};
  PointCovariance points_;
  std::vector<Eigen::Vector3d> x_in_world_;
};

TEST_F(Covariances, CovarianceOfIsThatOfTheDenseMatrix) {
  points_.signs[2] = -1.0;
  const Eigen::MatrixXd dense = Dense(points_);
  const PointGradient a = {{12, {1, 2, 3}}, {34, {-1, 0, 2}}},
                      b = {{14, {0, 1, 0}}, {12, {3, 1, 1}}};
  Eigen::VectorXd row_a = Eigen::VectorXd::Zero(24), row_b = row_a;
  row_a.segment<3>(3) << 1, 2, 3;
  row_a.segment<3>(21) << -1, 0, 2;
  row_b.segment<3>(9) << 0, 1, 0;
  row_b.segment<3>(3) << 3, 1, 1;
  EXPECT_NEAR(CovarianceOf(points_, a, b), row_a.dot(dense * row_b), 1e-12 * dense.norm());
  EXPECT_NEAR(CovarianceOf(points_, b, a), CovarianceOf(points_, a, b), 1e-12 * dense.norm());
  EXPECT_LT(RelativeError(PointCovarianceOf(points_, 31), dense.block<3, 3>(15, 15)), 1e-12);
  EXPECT_LT(RelativeError(Multiply(points_, row_a), dense * row_a), 1e-12);
}

TEST_F(Covariances, APointTwiceInAGradientCountsTwice) {
  const PointGradient once = {{22, {2, 0, 0}}}, twice = {{22, {1, 0, 0}}, {22, {1, 0, 0}}};
  EXPECT_NEAR(VarianceOf(points_, twice), VarianceOf(points_, once), 1e-12);
}

TEST_F(Covariances, UnknownPointIsABug) {
  EXPECT_THROW(VarianceOf(points_, {{99, {1, 0, 0}}}), std::logic_error);
  EXPECT_THROW(PointCovarianceOf(points_, 21), std::logic_error);
  EXPECT_EQ(points_.IndexOf(21), -1);
  EXPECT_EQ(points_.IndexOf(22), 4);
}

TEST_F(Covariances, VarianceIsNeverNegative) {
  points_.blocks.assign(1, Eigen::MatrixXd::Zero(24, 24));
  points_.factor = Random(24, 2);
  points_.factor.col(1) = points_.factor.col(0);
  points_.signs = Eigen::Vector2d(1, -1 - 1e-12);
  EXPECT_EQ(VarianceOf(points_, {{11, {1, 2, 3}}, {31, {1, 1, 1}}}), 0.0);
}

TEST_F(Covariances, SubsetKeepsTheJointCovariance) {
  const PointCovariance subset = Subset(points_, {34, 12, 11, 999});
  EXPECT_EQ(subset.point3D_ids, (std::vector<Point3DId>{11, 12, 34}));
  EXPECT_EQ(subset.blocks.size(), 2u);
  const std::vector<int> rows = {0, 1, 2, 3, 4, 5, 21, 22, 23};
  EXPECT_LT(RelativeError(Dense(subset), Dense(points_)(rows, rows)), 1e-12);
}

TEST_F(Covariances, MeasurementsAreKalmansUpdate) {
  const Eigen::MatrixXd dense = Dense(points_);
  const Eigen::MatrixXd gradients = Random(24, 2);
  const Eigen::Vector2d sigmas(0.3, 2.0);
  AddMeasurements(gradients, sigmas, &points_);
  const Eigen::MatrixXd information =
      dense.inverse() +
      gradients * sigmas.cwiseAbs2().cwiseInverse().asDiagonal() * gradients.transpose();
  EXPECT_LT(RelativeError(Dense(points_), information.inverse()), 1e-9);
}

TEST_F(Covariances, InnerConstraintsLeaveNoRigidMotion) {
  const Eigen::MatrixXd dense = Dense(points_);
  ToInnerConstraints(x_in_world_, &points_);
  Eigen::MatrixXd motions(24, 6);
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      motions.block<3, 1>(3 * i, axis) = Eigen::Vector3d::Unit(axis);
      motions.block<3, 1>(3 * i, 3 + axis) =
          Eigen::Vector3d(Eigen::Vector3d::Unit(axis)).cross(x_in_world_[i]);
    }
  }
  const Eigen::MatrixXd projector =
      Eigen::MatrixXd::Identity(24, 24) -
      motions * (motions.transpose() * motions).inverse() * motions.transpose();
  EXPECT_LT(RelativeError(Dense(points_), projector * dense * projector), 1e-10);
  EXPECT_LT((Dense(points_) * motions).norm() / dense.norm(), 1e-10);
}

TEST_F(Covariances, ScaleGradientIsThatOfTheAlignmentsScale) {
  const Eigen::VectorXd gradient = ScaleGradient(x_in_world_);
  Eigen::VectorXd stretched(24), shifted(24);
  for (int i = 0; i < 8; ++i) {
    stretched.segment<3>(3 * i) = 1e-3 * x_in_world_[i];
    shifted.segment<3>(3 * i) = Eigen::Vector3d(1, 2, 3);
  }
  EXPECT_NEAR(gradient.dot(stretched), 1e-3, 1e-15);
  EXPECT_NEAR(gradient.dot(shifted), 0.0, 1e-12);
}

}  // namespace
}  // namespace velamap
