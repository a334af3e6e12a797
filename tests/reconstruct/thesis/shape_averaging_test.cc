#include "reconstruct/thesis/shape_averaging.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace velamap {
namespace {

MarkerPoints Square(const Eigen::Vector3d& center, double tilt) {
  MarkerPoints points;
  points[0] = center;
  const Eigen::Vector3d x(std::cos(tilt), 0, std::sin(tilt)), y(0, 1, 0);
  points[1] = center + 0.05 * (y - x);
  points[2] = center + 0.05 * (y + x);
  points[3] = center + 0.05 * (x - y);
  points[4] = center - 0.05 * (x + y);
  return points;
}

std::vector<MarkerSolutions> NoisyFrames(int count, double sigma_m) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0.0, sigma_m);
  std::vector<MarkerSolutions> frames;
  for (int i = 0; i < count; ++i) {
    MarkerPoints points = Square({1, 2, 3}, 0.3);
    for (auto& x : points) {
      x += Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
    }
    frames.push_back({points});
  }
  return frames;
}

TEST(ShapeAveraging, EqualFramesGiveThatFrame) {
  const MarkerPoints points = Square({1, 2, 3}, 0.3);
  const MarkerPoints mean = AverageMarker({{points}, {points}, {points}}, {});
  EXPECT_LT(RmsDistance(mean, points), 1e-14);
}

TEST(ShapeAveraging, OrderOfFramesDoesNotMatter) {
  auto frames = NoisyFrames(31, 0.01);
  const MarkerPoints mean = AverageMarker(frames, {});
  std::reverse(frames.begin(), frames.end());
  EXPECT_LT(RmsDistance(AverageMarker(frames, {}), mean), 1e-12);
}

TEST(ShapeAveraging, MeanIsNearerToTheTruthThanAFrame) {
  const auto frames = NoisyFrames(100, 0.01);
  EXPECT_LT(RmsDistance(AverageMarker(frames, {}), Square({1, 2, 3}, 0.3)), 0.004);
}

TEST(ShapeAveraging, NarrowWeightsIgnoreAnOutlierThatThePlainMeanFollows) {
  auto frames = NoisyFrames(20, 0.001);
  frames.push_back({Square({1, 2, 4}, 0.3)});
  const MarkerPoints truth = Square({1, 2, 3}, 0.3);
  ThesisRegistrationOptions plain, narrow;
  plain.num_mean_iterations = 0;
  narrow.mean_sigma_m = 0.05;
  EXPECT_GT(RmsDistance(AverageMarker(frames, plain), truth), 0.04);
  EXPECT_LT(RmsDistance(AverageMarker(frames, narrow), truth), 0.002);
}

TEST(ShapeAveraging, FlippedSolutionIsLeftOutWhereFramesAgreeOnTheOther) {
  const MarkerPoints truth = Square({1, 2, 3}, 0.3);
  std::vector<MarkerSolutions> frames;
  for (int i = 0; i < 9; ++i) {
    // The wrong solution differs from frame to frame and comes first in most of them.
    const MarkerPoints flipped = Square({1, 2, 3}, -0.3 - 0.05 * i);
    frames.push_back(i % 3 == 0 ? MarkerSolutions{truth, flipped}
                                : MarkerSolutions{flipped, truth});
  }
  EXPECT_LT(RmsDistance(AverageMarker(frames, {}), truth), 1e-12);
}

}  // namespace
}  // namespace velamap
