#include "exporters/shape/joint_covariance.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/exporters/example_covariance.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

// Gradients with several points, one of them twice.
std::vector<PointGradient> Gradients() {
  return {{{11, {1, 0, 0}}, {12, {0, -1, 0.5}}, {1203, {2, 2, 2}}},
          {{12, {0.3, 0, 0}}, {12, {0, 0.3, 0}}},
          {{1214, {0, 0, 1}}},
          {}};
}

TEST(JointCovariance, IsTheDenseProduct) {
  const PointCovariance covariance = ExampleCovariance(ExampleModel(), 1e-3, 1);
  const Eigen::MatrixXd dense = DenseCovariance(covariance);
  const auto gradients = Gradients();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(4, dense.rows());
  for (int i = 0; i < 4; ++i) {
    for (const auto& [id, value] : gradients[i]) {
      rows.block<1, 3>(i, 3 * covariance.IndexOf(id)) += value.transpose();
    }
  }
  const Eigen::MatrixXd expected = rows * dense * rows.transpose();
  EXPECT_LT((JointCovarianceOf(covariance, gradients) - expected).cwiseAbs().maxCoeff(), 1e-18);
  EXPECT_GT(expected(0, 1), 1e-9);
}

TEST(JointCovariance, HoldsWhatSinglePairsGive) {
  const PointCovariance covariance = ExampleCovariance(ExampleModel(), 1e-3, 2);
  const auto gradients = Gradients();
  const Eigen::MatrixXd joint = JointCovarianceOf(covariance, gradients);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      EXPECT_NEAR(joint(i, j), CovarianceOf(covariance, gradients[i], gradients[j]), 1e-18);
    }
  }
}

TEST(JointCovariance, AnUnknownPointIsAMistakeOfOurs) {
  const PointCovariance covariance = ExampleCovariance(ExampleModel(), 1e-3, 2);
  EXPECT_THROW(JointCovarianceOf(covariance, {{{9991, {1, 0, 0}}}}), std::logic_error);
}

}  // namespace
}  // namespace velamap
