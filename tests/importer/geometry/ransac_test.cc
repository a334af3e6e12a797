#include "importer/geometry/ransac.h"

#include <cmath>

#include <gtest/gtest.h>

namespace velamap {
namespace {

// A number that is the model, its hypothesis and nearly the data: knows what it was asked.
struct NumberHypothesis {
  double value = 0.0;
  double cost = 0.0;
  std::vector<int> inlier_idxs = {};
};

struct FakeEstimator {
  using Model = double;
  using Hypothesis = NumberHypothesis;
  static constexpr int kSampleSize = 3;

  int num_inliers = 0;  // of ten data
  // The inliers change when the cost, in these units, falls below another integer.
  double unit_of_cost = 1e-3;
  mutable int num_samples = 0;
  mutable int num_refinements = 0;

  // Every fourth sample is degenerate; the others give two models.
  std::vector<double> Generate(std::mt19937* generator) const {
    if (num_samples++ % 4 == 3) return {};
    const double value = static_cast<double>(RandomIndex(generator, 1000));
    return {value, value + 0.5};
  }
  int NumData() const { return 10; }
  NumberHypothesis Score(double value) const {
    const double cost = std::abs(value - 300);
    const auto inlier = static_cast<int>(std::floor(cost / unit_of_cost));
    return {value, cost, std::vector<int>(static_cast<std::size_t>(num_inliers), inlier)};
  }
  // Halves the distance to 300, and overshoots once within 1.
  NumberHypothesis Refine(const NumberHypothesis& hypothesis) const {
    ++num_refinements;
    const double off = hypothesis.value - 300;
    return Score(300 + (std::abs(off) > 1 ? 0.5 * off : -2 * off));
  }
};

TEST(Ransac, DrawsAsManySamplesAsTheInlierRatioNeeds) {
  const std::pair<int, int> expected[] = {{10, 12}, {9, 16}, {5, 156}, {2, 160}, {0, 160}};
  for (const auto& [num_inliers, num_samples] : expected) {
    const FakeEstimator estimator{num_inliers};
    const auto hypotheses = Ransac({12, 160, 0}, estimator);
    EXPECT_EQ(estimator.num_samples, num_samples) << num_inliers;
    EXPECT_EQ(hypotheses.size(), 2u * static_cast<std::size_t>(num_samples - num_samples / 4));
  }
}

TEST(Ransac, MissesWithAProbabilityBelowOneInABillion) {
  for (const double inlier_ratio : {0.6, 0.8, 0.95}) {
    const int num_samples = NumSamples(inlier_ratio, 3, {1, 100000, 0});
    const double miss = 1 - std::pow(inlier_ratio, 3);
    EXPECT_LE(std::pow(miss, num_samples), 1e-9);
    EXPECT_GT(std::pow(miss, num_samples - 2), 1e-9);
  }
}

TEST(Ransac, HypothesesComeBestFirstWithTheInitialOnes) {
  const FakeEstimator estimator{10};
  const auto hypotheses = Ransac({12, 160, 7}, estimator, {300.25, 1e6});
  EXPECT_EQ(hypotheses.front().value, 300.25);
  EXPECT_EQ(hypotheses.back().value, 1e6);
  for (std::size_t i = 1; i < hypotheses.size(); ++i) {
    EXPECT_LE(hypotheses[i - 1].cost, hypotheses[i].cost);
  }
}

TEST(Ransac, SeedsDifferAndTheSameSeedRepeats) {
  const auto best = [](std::uint32_t seed) {
    return Ransac({12, 160, seed}, FakeEstimator{10}).front().value;
  };
  EXPECT_EQ(best(1), best(1));
  EXPECT_NE(best(1), best(2));
}

TEST(Ransac, WithoutSamplesTheInitialOnesAreAll) {
  const FakeEstimator estimator{10};
  EXPECT_EQ(Ransac({12, 0, 0}, estimator, {1.0, 2.0}).size(), 2u);
  EXPECT_TRUE(Ransac({0, 0, 0}, estimator).empty());
  EXPECT_EQ(estimator.num_samples, 0);
}

TEST(RefineHypothesis, GoesOnWhileTheCostFalls) {
  const FakeEstimator estimator{1};
  EXPECT_EQ(RefineHypothesis(estimator, 2, estimator.Score(308)).value, 302);
  EXPECT_EQ(estimator.num_refinements, 2);
  // 308, 304, 302, 301; the next one costs more.
  EXPECT_EQ(RefineHypothesis(estimator, 100, estimator.Score(308)).value, 301);
  EXPECT_EQ(estimator.num_refinements, 2 + 4);
}

TEST(RefineHypothesis, EndsWhereTheInliersHaveSettled) {
  // The tens of the distance from 300 settle long before the cost does.
  const FakeEstimator estimator{1, 10.0};
  // 340, 320, 310, 305, 302.5; the last step changes no inlier.
  EXPECT_EQ(RefineHypothesis(estimator, 100, estimator.Score(340)).value, 302.5);
  EXPECT_EQ(estimator.num_refinements, 4);
  EXPECT_EQ(RefineHypothesis(estimator, 100, estimator.Score(308)).value, 304);
  EXPECT_EQ(estimator.num_refinements, 4 + 1);
}

TEST(DistinctHypotheses, KeepsTheBestOfThoseThatAreNearlyTheSame) {
  const auto is_same = [](const NumberHypothesis& a, const NumberHypothesis& b) {
    return std::abs(a.value - b.value) < 0.5;
  };
  const std::vector<NumberHypothesis> hypotheses = {{10.1, 4}, {1.4, 2}, {5.0, 2}, {1.0, 1},
                                                    {1.8, 3},  {5.0, 9}, {10.0, 4}};
  const auto values = [&](std::size_t max_count) {
    std::vector<double> kept;
    for (const NumberHypothesis& hypothesis : DistinctHypotheses(hypotheses, is_same, max_count)) {
      kept.push_back(hypothesis.value);
    }
    return kept;
  };
  // 1.4 is left out and therefore leaves 1.8 in; of equal costs, the first one counts.
  EXPECT_EQ(values(10), (std::vector<double>{1.0, 5.0, 1.8, 10.1}));
  EXPECT_EQ(values(2), (std::vector<double>{1.0, 5.0}));
  EXPECT_TRUE(values(0).empty());
}

TEST(RandomIndex, CoversTheRangeEvenly) {
  std::mt19937 generator(1);
  std::vector<int> counts(7, 0);
  for (int i = 0; i < 7000; ++i) ++counts[RandomIndex(&generator, counts.size())];
  for (const int count : counts) EXPECT_NEAR(count, 1000, 150);
}

}  // namespace
}  // namespace velamap
