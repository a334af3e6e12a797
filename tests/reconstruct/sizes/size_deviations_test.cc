#include "reconstruct/sizes/size_deviations.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

constexpr double kToleranceOfPrint = 1e-3;

// In which share of random clips the markers are said to scatter more than their print tolerance
// and the noise of the images explain. They scatter `factor` times as far, and share an error of
// this sigma, with a random factor for each marker.
double ShareThatScattersMore(std::size_t num_markers, double noise, double factor,
                             double shared_sigma = 0.0) {
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
    const double shared = shared_sigma * normal(random);
    for (std::size_t i = 0; i < num_markers; ++i) {
      const double share_of_marker = shared_sigma > 0 ? normal(random) : 0.0;
      deviations.values[i] = sigma * normal(random) + shared * share_of_marker;
      deviations.shared[i] = Eigen::VectorXd::Constant(1, shared_sigma * share_of_marker);
      deviations.variances[i] = variance + deviations.shared[i].squaredNorm();
    }
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
    EXPECT_GT(ShareThatScattersMore(num_markers, 1e-3, 3.0, 1e-2), 0.8) << num_markers;
  }
}

// Without the covariances between markers, 5, 7 and 13 % of the clips are said to scatter more.
TEST(SizeDeviations, AnErrorThatMarkersShareIsNoScatter) {
  for (const std::size_t num_markers : {10, 24, 120}) {
    EXPECT_LT(ShareThatScattersMore(num_markers, 1e-3, 1.0, 1e-2), 0.01) << num_markers;
  }
}

}  // namespace
}  // namespace velamap
