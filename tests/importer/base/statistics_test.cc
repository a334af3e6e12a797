#include "importer/base/statistics.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(ComputeStatistics, HandComputedExample) {
  const Statistics s = ComputeStatistics({4, 1, 3, 8});
  EXPECT_EQ(s.count, 4);
  EXPECT_DOUBLE_EQ(s.mean, 4);
  EXPECT_DOUBLE_EQ(s.standard_deviation, std::sqrt(26.0 / 3.0));
  EXPECT_DOUBLE_EQ(s.median, 3.5);
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.max, 8);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(90.0 / 4.0));
}

TEST(ComputeStatistics, NoValuesGiveZeros) {
  const Statistics s = ComputeStatistics({});
  EXPECT_EQ(s.count, 0);
  EXPECT_EQ(s.mean, 0);
  EXPECT_EQ(s.rms, 0);
}

TEST(ComputeStatistics, OneValueHasNoDeviation) {
  const Statistics s = ComputeStatistics({-3});
  EXPECT_EQ(s.mean, -3);
  EXPECT_EQ(s.median, -3);
  EXPECT_EQ(s.standard_deviation, 0);
  EXPECT_EQ(s.rms, 3);
}

TEST(ComputeStatistics, TheLargestIsTakenWithoutItsSign) {
  EXPECT_EQ(ComputeStatistics({-5, 2, 3}).MaxAbs(), 5);
  EXPECT_EQ(ComputeStatistics({-5, 2, 7}).MaxAbs(), 7);
  EXPECT_EQ(ComputeStatistics({}).MaxAbs(), 0);
}

TEST(ComputeStatistics, OrderOfTheInputIsWithoutEffect) {
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(std::sin(i) * std::pow(10, i % 9));
  const Statistics forward = ComputeStatistics(values);
  const Statistics backward = ComputeStatistics({values.rbegin(), values.rend()});
  EXPECT_EQ(forward.mean, backward.mean);
  EXPECT_EQ(forward.rms, backward.rms);
  EXPECT_EQ(forward.standard_deviation, backward.standard_deviation);
}

TEST(Median, OddAndEven) {
  EXPECT_EQ(Median({5, 1, 3}), 3);
  EXPECT_EQ(Median({5, 1, 3, 4}), 3.5);
  EXPECT_THROW(Median({}), std::logic_error);
}

TEST(RobustSigma, ShrugsOffOutliersBelowHalf) {
  std::vector<double> values;
  for (int i = -50; i <= 50; ++i) values.push_back(7.0 + i);
  const double sigma = RobustSigma(values);
  EXPECT_DOUBLE_EQ(sigma, 1.4826 * 25);
  for (int i = 0; i < 3; ++i) values.push_back(1e9);
  EXPECT_NEAR(RobustSigma(values), sigma, 2.0);
}

TEST(RobustSigma, ScalesAndIgnoresAShift) {
  const std::vector<double> values = {0.1, 2.0, -4.0, 0.7, 9.0};
  std::vector<double> moved;
  for (const double value : values) moved.push_back(100 - 3 * value);
  EXPECT_NEAR(RobustSigma(moved), 3 * RobustSigma(values), 1e-12);
}

TEST(Rms, IsTheRootOfTheMeanSquare) {
  EXPECT_DOUBLE_EQ(Rms({3, -4, 5, 0}), std::sqrt(12.5));
  EXPECT_EQ(Rms({}), 0);
}

TEST(Thinned, KeepsAFewEvenlyOverTheList) {
  const std::vector<int> items = {0, 1, 2, 3, 4, 5, 6};
  EXPECT_EQ(Thinned(items, 3), (std::vector<int>{0, 2, 4}));
  EXPECT_EQ(Thinned(items, 7), items);
  EXPECT_EQ(Thinned(items, 8), items);
  EXPECT_TRUE(Thinned(items, 0).empty());
}

}  // namespace
}  // namespace velamap
