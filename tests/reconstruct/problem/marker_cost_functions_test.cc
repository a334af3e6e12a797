#include "reconstruct/problem/marker_cost_functions.h"

#include <cmath>
#include <limits>

#include <ceres/gradient_checker.h>
#include <ceres/manifold.h>
#include <ceres/product_manifold.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "reconstruct/problem/prior_cost_functions.h"

namespace velamap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using PoseManifold =
    ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>;

// Derivatives by Ridders' method, in the tangent space of the manifolds.
void CheckGradients(const ceres::CostFunction& error,
                    const std::vector<std::vector<double>>& blocks,
                    const std::vector<const ceres::Manifold*>& manifolds) {
  ceres::NumericDiffOptions options;
  options.ridders_relative_initial_step_size = 1e-3;
  const ceres::GradientChecker checker(&error, &manifolds, options);
  std::vector<const double*> parameters;
  for (const auto& block : blocks) parameters.push_back(block.data());
  ceres::GradientChecker::ProbeResults results;
  EXPECT_TRUE(checker.Probe(parameters.data(), 1e-6, &results)) << results.error_log;
}

std::vector<double> ParamsOf(CameraModel model) {
  switch (model) {
    case CameraModel::kSimplePinhole:
      return {1200, 960, 540};
    case CameraModel::kPinhole:
      return {1200, 1210, 960, 540};
    case CameraModel::kSimpleRadial:
      return {1200, 960, 540, -0.05};
    case CameraModel::kRadial:
      return {1200, 960, 540, -0.05, 0.02};
    case CameraModel::kOpenCV:
      return {1200, 1210, 960, 540, -0.1, 0.03, 4e-3, -3e-3};
    case CameraModel::kOpenCVFisheye:
      return {1200, 1210, 960, 540, -0.05, 0.02, -0.01, 0.005};
    case CameraModel::kFullOpenCV:
      return {1200, 1210, 960, 540, -0.1, 0.03, 4e-3, -3e-3, 0.01, 0.05, -0.02, 0.004};
  }
  return {};
}

// Marker, pose, inset, intrinsics, shutter: a marker somewhat bent, 1.5 m away, off the axis.
std::vector<std::vector<double>> ViewParameters(CameraModel model) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(0.9, 0.2, -0.3, 0.1).normalized();
  return {{0.01, 0.02, 0, 0.11, 0.02, 0.003, 0.11, -0.08, -0.002, 0.012, -0.08, 0.004},
          {q.x(), q.y(), q.z(), q.w(), 0.3, -0.2, 1.5},
          {0.07},
          ParamsOf(model),
          {0.02}};
}

std::vector<CornerObservation> Observations(const std::vector<int>& slots) {
  std::vector<CornerObservation> observations;
  for (const int slot : slots) {
    CornerObservation observation;
    observation.slot = slot;
    observation.x_in_image_px = {1200 + 40.0 * (slot == 1 || slot == 2), 380 - 35.0 * (slot > 1)};
    observation.sigma_px = 30.0 + slot;  // so that the loss is at work, but not all there is
    observation.inset_direction = Eigen::Vector2d(0.8, -0.5 + 0.1 * slot);
    observation.motion = {0.1 * slot - 0.3,
                          {0, 1.0 / 1080},
                          {{900.0 - 500 * slot, 300.0 + 200 * slot}, {4000.0, 7000.0 * slot}}};
    observations.push_back(observation);
  }
  return observations;
}

class MarkerViewErrorOf : public testing::TestWithParam<CameraModel> {};

TEST_P(MarkerViewErrorOf, JacobiansAreThoseOfTheResiduals) {
  const PoseManifold pose;
  for (const double loss_sigmas : {kInfinity, 3.0}) {
    const double correlation = std::isinf(loss_sigmas) ? 0.0 : 0.3;
    for (const std::vector<int>& slots : {std::vector<int>{0, 1, 2, 3}, {2}, {3, 1}}) {
      const MarkerViewError error(GetParam(), 4, Observations(slots), correlation, loss_sigmas);
      CheckGradients(error, ViewParameters(GetParam()),
                     {nullptr, &pose, nullptr, nullptr, nullptr});
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllModels, MarkerViewErrorOf,
                         testing::Values(CameraModel::kSimplePinhole, CameraModel::kPinhole,
                                         CameraModel::kSimpleRadial, CameraModel::kRadial,
                                         CameraModel::kOpenCV, CameraModel::kOpenCVFisheye,
                                         CameraModel::kFullOpenCV),
                         [](const auto& test) { return CameraModelName(test.param); });

TEST(MarkerViewError, ResidualIsProjectionPlusInsetAndMotionMinusObservationInSigmas) {
  auto parameters = ViewParameters(CameraModel::kOpenCV);
  const auto observations = Observations({2});
  const MarkerViewError error(CameraModel::kOpenCV, 4, observations, 0.3, kInfinity);
  std::vector<const double*> blocks;
  for (const auto& block : parameters) blocks.push_back(block.data());
  Eigen::Vector2d residual;
  ASSERT_TRUE(error.Evaluate(blocks.data(), residual.data(), nullptr));
  const Camera camera{CameraModel::kOpenCV, 1920, 1080, parameters[3]};
  const Eigen::Quaterniond rotation(parameters[1].data());
  const Eigen::Vector3d x_in_cam =
      rotation * Eigen::Vector3d(&parameters[0][6]) + Eigen::Vector3d(&parameters[1][4]);
  const Eigen::Vector2d expected =
      (ImageFromCam(camera, x_in_cam).value() + 0.07 * observations[0].inset_direction +
       ShiftByRow(observations[0].motion, 0.02).value_px - observations[0].x_in_image_px) /
      32.0;
  EXPECT_LT((residual - expected).norm(), 1e-12);
}

TEST(MarkerViewError, CornerBehindTheCameraCannotBeEvaluated) {
  auto parameters = ViewParameters(CameraModel::kPinhole);
  parameters[1][6] = -2.0;
  const MarkerViewError error(CameraModel::kPinhole, 4, Observations({0}), 0.0, 3.0);
  std::vector<const double*> blocks;
  for (const auto& block : parameters) blocks.push_back(block.data());
  Eigen::Vector2d residual;
  EXPECT_FALSE(error.Evaluate(blocks.data(), residual.data(), nullptr));
}

TEST(RobustResidual, SquareIsCauchysLossAndSmallOnesPass) {
  for (const double length : {1e-9, 1e-4, 0.01, 1.0, 10.0, 1e4}) {
    const Eigen::Vector2d whitened = length * Eigen::Vector2d(0.6, -0.8);
    const double q = length * length / 9.0;
    EXPECT_NEAR(RobustResidual(whitened, 3.0, nullptr).squaredNorm() / (9.0 * std::log1p(q)), 1.0,
                1e-9);
  }
  EXPECT_EQ(RobustResidual({5, -7}, kInfinity, nullptr), Eigen::Vector2d(5, -7));
}

TEST(RobustResidual, JacobianHoldsWhereTheSeriesTakesOver) {
  for (const double length : {1e-6, 0.0094, 0.0096, 0.5, 3.0, 200.0}) {
    const Eigen::Vector2d whitened = length * Eigen::Vector2d(0.6, -0.8);
    Eigen::Matrix2d jacobian;
    RobustResidual(whitened, 3.0, &jacobian);
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = 1e-4 * length * Eigen::Vector2d::Unit(axis);
      const Eigen::Vector2d numeric = (RobustResidual(whitened + step, 3.0, nullptr) -
                                       RobustResidual(whitened - step, 3.0, nullptr)) /
                                      (2e-4 * length);
      EXPECT_LT((jacobian.col(axis) - numeric).norm(), 1e-7) << length;
    }
  }
}

TEST(MarkerPriorError, JacobiansAreThoseOfTheResiduals) {
  const auto marker = ViewParameters(CameraModel::kPinhole)[0];
  const MarkerPrior prior{0.1, 1e-3, 3e-3, 2e-3};
  CheckGradients(MarkerPriorError(prior, {1, 2, 3, 4}), {marker, {0.01}, {-0.02}},
                 {nullptr, nullptr, nullptr});
  const std::vector<double> three(marker.begin(), marker.begin() + 9);
  CheckGradients(MarkerPriorError(prior, {1, 3, 4}), {three, {0.01}, {-0.02}},
                 {nullptr, nullptr, nullptr});
}

TEST(MarkerPriorError, KnowsSidesAndFlatness) {
  const double h = 0.004;
  const std::vector<double> marker = {0, 0, h, 0.1, 0, -h, 0.1, 0.1, h, 0, 0.1, -h};
  const double print_scale = 0.03, part_scale = -0.01;
  const double* blocks[] = {marker.data(), &print_scale, &part_scale};
  const MarkerPriorError error({0.1, 1e-3, 3e-3, 2e-3}, {1, 2, 3, 4});
  ASSERT_EQ(error.num_residuals(), 6);
  double residuals[6];
  ASSERT_TRUE(error.Evaluate(blocks, residuals, nullptr));
  for (int side = 0; side < 4; ++side) {
    EXPECT_NEAR(residuals[side], (std::hypot(0.1, 2 * h) / 1.02 - 0.1) / 1e-3, 1e-12);
  }
  EXPECT_NEAR(residuals[4], 0.0, 1e-12);
  EXPECT_NEAR(std::abs(residuals[5]), h / 1.02 / 2e-3, 1e-12);
}

TEST(MarkerPriorError, ExpectsTheDiagonalsOfABentMarker) {
  const std::vector<double> marker = {0, 0, 0, 0.1, 0, 0, 0.101, 0.1, 0, 0, 0.1, 0};
  const double difference_m = std::hypot(0.101, 0.1) - std::hypot(0.1, 0.1), print_scale = 0.0;
  const double* blocks[] = {marker.data(), &print_scale, &print_scale};
  MarkerPrior prior{0.1, 0, 3e-3, 0};
  double residual = 0.0;
  ASSERT_TRUE(MarkerPriorError(prior, {1, 2, 3, 4}).Evaluate(blocks, &residual, nullptr));
  EXPECT_NEAR(residual, difference_m / 3e-3, 1e-12);
  prior.chords.diagonals_difference = difference_m / 0.1;
  ASSERT_TRUE(MarkerPriorError(prior, {1, 2, 3, 4}).Evaluate(blocks, &residual, nullptr));
  EXPECT_NEAR(residual, 0, 1e-12);
}

TEST(MarkerPriorError, RhombusIsNoSquare) {
  // Sides of 0.1, sheared by an angle of 0.02 rad.
  const double x = 0.1 * std::sin(0.02), y = 0.1 * std::cos(0.02);
  const std::vector<double> marker = {0, 0, 0, 0.1, 0, 0, 0.1 + x, y, 0, x, y, 0};
  const double print_scale = 0;
  const double* blocks[] = {marker.data(), &print_scale, &print_scale};
  const MarkerPriorError error({0.1, 1e-3, 3e-3, 2e-3}, {1, 2, 3, 4});
  double residuals[6];
  ASSERT_TRUE(error.Evaluate(blocks, residuals, nullptr));
  for (const int side : {0, 1, 2, 3}) EXPECT_NEAR(residuals[side], 0.0, 1e-12);
  EXPECT_NEAR(residuals[4] * 3e-3, std::hypot(0.1 + x, y) - std::hypot(0.1 - x, y), 1e-12);
}

TEST(MarkerPriorError, OnlyWhatIsKnownCounts) {
  EXPECT_EQ(MarkerPriorError({0.1, 1e-3, 0, 0}, {1, 2, 3, 4}).num_residuals(), 4);
  EXPECT_EQ(MarkerPriorError({0.1, 0, 0, 1e-3}, {1, 2, 3, 4}).num_residuals(), 1);
  EXPECT_EQ(MarkerPriorError({0.1, 1e-3, 1e-3, 1e-3}, {1, 2, 4}).num_residuals(), 2);
  EXPECT_EQ(MarkerPriorError({0.1, 1e-3, 1e-3, 1e-3}, {1, 3}).num_residuals(), 0);
}

TEST(ScaleBarError, JacobiansAreThoseOfTheResiduals) {
  const std::vector<double> marker1 = {0, 0, 0, 0.1, 0, 0, 0.1, 0.1, 0, 0, 0.1, 0};
  const std::vector<double> marker2 = {1, 0, 0.2, 1.1, 0.05, 0.3};
  const ScaleBarError error(1.1, 1e-3, {{-0.25, -0.25, -0.25, -0.25}, {0, 1}});
  CheckGradients(error, {marker1, marker2}, {nullptr, nullptr});
  double residual;
  const double* blocks[] = {marker1.data(), marker2.data()};
  ASSERT_TRUE(error.Evaluate(blocks, &residual, nullptr));
  EXPECT_NEAR(residual, (Eigen::Vector3d(1.05, 0, 0.3).norm() - 1.1) / 1e-3, 1e-9);
}

TEST(ParameterPriorError, JacobiansAreThoseOfTheResiduals) {
  const ParameterPriorError error({1, 2}, {0.1, 10});
  CheckGradients(error, {{1.5, -3}}, {nullptr});
  double residuals[2];
  const double values[] = {1.5, -3};
  const double* blocks[] = {values};
  ASSERT_TRUE(error.Evaluate(blocks, residuals, nullptr));
  EXPECT_NEAR(residuals[0], 5, 1e-12);
  EXPECT_NEAR(residuals[1], -0.5, 1e-12);
}

}  // namespace
}  // namespace velamap
