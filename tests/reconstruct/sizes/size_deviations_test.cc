#include "reconstruct/sizes/size_deviations.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

constexpr double kToleranceOfPrint = 1e-3;

// In which share of random clips the markers are said to scatter more than their print tolerance
// and the noise of the images explain. They scatter `factor` times as far.
double ShareThatScattersMore(std::size_t num_markers, double noise, double factor) {
  constexpr int kNumDraws = 400;
  std::mt19937 random(static_cast<std::uint32_t>(num_markers));
  std::normal_distribution<double> normal;
  std::vector<MarkerSize> sizes(num_markers);
  for (MarkerSize& size : sizes) size.num_sides = 4;
  const double variance = noise * noise;
  const double sigma = factor * std::sqrt(variance + kToleranceOfPrint * kToleranceOfPrint / 4);
  double share = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    Deviations deviations(num_markers);
    deviations.num_groups = 1;
    for (double& value : deviations.values) value = sigma * normal(random);
    for (double& value : deviations.variances) value = variance;
    share +=
        JudgeDeviations(deviations, sizes, kToleranceOfPrint).scatters_more / double{kNumDraws};
  }
  return share;
}

// The median of ten deviations varies by 37 % around its expectation.
TEST(SizeDeviations, OfGoodPrintsScatterMoreInFewCases) {
  for (const std::size_t num_markers : {5, 9, 10, 12, 20, 40, 120}) {
    for (const double noise : {0.0, 1e-3, 1e-2}) {
      EXPECT_LT(ShareThatScattersMore(num_markers, noise, 1.0), 0.01)
          << num_markers << ' ' << noise;
    }
  }
}

TEST(SizeDeviations, OfBadPrintsAreSaidToScatterMore) {
  for (const std::size_t num_markers : {12, 20, 40}) {
    EXPECT_GT(ShareThatScattersMore(num_markers, 1e-3, 3.0), 0.9) << num_markers;
  }
}

}  // namespace
}  // namespace velamap
