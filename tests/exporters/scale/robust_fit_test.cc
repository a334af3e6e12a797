#include "exporters/scale/robust_fit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace velamap {
namespace {

std::vector<double> Normal(double mean, double sigma, int count, std::mt19937* random) {
  std::normal_distribution<double> normal(mean, sigma);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(normal(*random));
  return values;
}

TEST(RobustFit, AgreeingValuesHaveTheirMeanAndNoScatter) {
  const RobustMean mean = FitMeanRobustly({0.25, 0.25, 0.25}, {0, 0, 0});
  EXPECT_NEAR(mean.mean, 0.25, 1e-12);
  EXPECT_LT(mean.excess_sigma, 1e-9);
  for (const double off : mean.sigmas_off) EXPECT_LE(std::abs(off), kMaxRobustSigmas);
}

TEST(RobustFit, ShiftAndScaleGoThrough) {
  std::mt19937 random(1);
  const std::vector<double> values = Normal(0.0, 1.0, 40, &random), sigmas(40, 0.5);
  const RobustMean expected = FitMeanRobustly(values, sigmas);
  std::vector<double> moved, moved_sigmas(40, 0.005);
  for (const double value : values) moved.push_back(7 + 0.01 * value);
  const RobustMean mean = FitMeanRobustly(moved, moved_sigmas);
  EXPECT_NEAR(mean.mean, 7 + 0.01 * expected.mean, 1e-9);
  EXPECT_NEAR(*mean.sigma, 0.01 * *expected.sigma, 1e-9);
  EXPECT_NEAR(mean.excess_sigma, 0.01 * expected.excess_sigma, 1e-9);
}

TEST(RobustFit, OutliersMoveNothingAndAreMarked) {
  std::mt19937 random(2);
  std::vector<double> values = Normal(1.0, 0.01, 30, &random);
  const RobustMean clean = FitMeanRobustly(values, std::vector<double>(30, 0.0));
  for (int i = 0; i < 10; ++i) values.push_back(i % 2 == 0 ? 5.0 : -80.0);
  const RobustMean mean = FitMeanRobustly(values, std::vector<double>(40, 0.0));
  EXPECT_NEAR(mean.mean, clean.mean, 0.004);
  for (int i = 30; i < 40; ++i) EXPECT_GT(std::abs(mean.sigmas_off[i]), kMaxRobustSigmas);
}

TEST(RobustFit, ExcessIsWhatTheOwnSigmasDoNotExplain) {
  std::mt19937 random(3);
  std::vector<double> values, sigmas;
  for (int i = 0; i < 4000; ++i) {
    sigmas.push_back(i % 2 == 0 ? 0.1 : 0.4);
    values.push_back(Normal(2.0, std::hypot(sigmas.back(), 0.3), 1, &random)[0]);
  }
  const RobustMean mean = FitMeanRobustly(values, sigmas);
  EXPECT_NEAR(mean.excess_sigma, 0.3, 0.02);
  EXPECT_NEAR(mean.mean, 2.0, 0.02);
  // Half have variance 0.1, half 0.25.
  EXPECT_NEAR(*mean.sigma, 1 / std::sqrt(2000 / 0.1 + 2000 / 0.25), 4e-4);
  for (double& sigma : sigmas) sigma = 1.0;
  EXPECT_EQ(FitMeanRobustly(values, sigmas).excess_sigma, 0.0);
}

// The sigma of the mean matches the scatter of the mean over repetitions.
TEST(RobustFit, SigmaIsCalibrated) {
  std::mt19937 random(4);
  int num_within = 0;
  constexpr int kNumRuns = 600;
  for (int run = 0; run < kNumRuns; ++run) {
    const RobustMean mean =
        FitMeanRobustly(Normal(0.0, 1.0, 30, &random), std::vector<double>(30, 0.0));
    if (std::abs(mean.mean) < *mean.sigma) ++num_within;
  }
  EXPECT_NEAR(num_within / static_cast<double>(kNumRuns), 0.66, 0.06);
}

TEST(RobustFit, ASingleValueHasTheSigmaThatItBrings) {
  EXPECT_FALSE(FitMeanRobustly({0.1}, {0.0}).sigma.has_value());
  EXPECT_NEAR(*FitMeanRobustly({0.1}, {0.02}).sigma, 0.02, 1e-12);
}

TEST(RobustFit, ALineWithOutliersIsFound) {
  std::mt19937 random(5);
  Eigen::MatrixXd design(40, 2);
  Eigen::VectorXd values(40);
  for (int i = 0; i < 40; ++i) {
    design.row(i) << 1, 1e4 * i;  // columns of any unit
    values[i] = 3 - 2e-4 * i + Normal(0, 1e-5, 1, &random)[0] + (i % 8 == 3 ? 0.2 : 0.0);
  }
  const auto fit = FitRobustly(design, values, Eigen::VectorXd::Zero(40));
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->coefficients[0], 3, 1e-5);
  EXPECT_NEAR(fit->coefficients[1], -2e-8, 4e-10);
  EXPECT_NEAR(fit->excess_sigma, 1e-5, 4e-6);
  EXPECT_LT(std::sqrt(fit->covariance(1, 1)), 4e-10);
  EXPECT_GE((fit->sigmas_off.array().abs() > kMaxRobustSigmas).count(), 5);
}

TEST(RobustFit, WhatIsNotDeterminedHasNoFit) {
  const Eigen::MatrixXd same = Eigen::MatrixXd::Constant(5, 2, 3.0);
  EXPECT_FALSE(FitRobustly(same, Eigen::VectorXd::Ones(5), Eigen::VectorXd::Zero(5)).has_value());
  const Eigen::MatrixXd wide = Eigen::MatrixXd::Random(2, 3);
  EXPECT_FALSE(FitRobustly(wide, Eigen::VectorXd::Ones(2), Eigen::VectorXd::Zero(2)).has_value());
}

// Of few values, the fit follows some.
TEST(RobustFit, TheScatterOfFewValuesIsNotTakenTooSmall) {
  const RobustMean mean = FitMeanRobustly({-2, -1, 0, 1, 2}, std::vector<double>(5, 0.0));
  EXPECT_NEAR(mean.mean, 0.0, 1e-6);
  EXPECT_NEAR(mean.excess_sigma, 1.4826 * std::sqrt(5.0 / 4.0), 1e-3);
}

}  // namespace
}  // namespace velamap
