// Robust consensus: RANSAC (Fischler and Bolles, 1981) with the number of samples adapted to the
// best hypothesis. The loop knows nothing of what is estimated: an estimator draws samples,
// generates models from them, scores and refines hypotheses.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace velamap {

struct RansacOptions {
  // Within these limits, enough samples are drawn that the chance of drawing none without outliers
  // is one in a billion.
  int min_num_samples = 12;
  int max_num_samples = 160;
  std::uint32_t random_seed = 0;
};

// The number of samples of `sample_size` data each for which the probability that every sample
// holds an outlier is below 1e-9 at this ratio of inliers; within the limits of the options.
inline int NumSamples(double inlier_ratio, int sample_size, const RansacOptions& options) {
  constexpr double kMissProbability = 1e-9;
  const double log_miss = std::log1p(-std::pow(inlier_ratio, sample_size));
  if (log_miss * options.max_num_samples >= std::log(kMissProbability)) {
    return options.max_num_samples;
  }
  const int num_samples = static_cast<int>(std::log(kMissProbability) / log_miss) + 1;
  return std::min(options.max_num_samples, std::max(options.min_num_samples, num_samples));
}

// An index below `size`. std::uniform_int_distribution differs between standard libraries; this
// does not.
inline std::size_t RandomIndex(std::mt19937* generator, std::size_t size) {
  return static_cast<std::size_t>(
      (static_cast<std::uint64_t>((*generator)()) * static_cast<std::uint64_t>(size)) >> 32);
}

// All hypotheses that were scored, by ascending cost; of equal ones, those of `initial_models` come
// before those of random samples. An Estimator has
//   Model, Hypothesis     types; a Hypothesis has the members `cost` and `inlier_idxs`
//   kSampleSize           the number of data that determine a model
//   NumData()             the number of data; the inliers are a subset of them
//   Generate(generator)   the models of one random sample; none for a degenerate one
//   Score(model)          the hypothesis of a model
// The result depends on the seed and the input only.
template <typename Estimator>
std::vector<typename Estimator::Hypothesis> Ransac(
    const RansacOptions& options, const Estimator& estimator,
    const std::vector<typename Estimator::Model>& initial_models = {}) {
  using Hypothesis = typename Estimator::Hypothesis;
  std::vector<Hypothesis> hypotheses;
  std::size_t best = 0;
  double inlier_ratio = 0.0;
  const auto score_all = [&](const std::vector<typename Estimator::Model>& models) {
    for (const auto& model : models) {
      hypotheses.push_back(estimator.Score(model));
      if (hypotheses.size() > 1 && !(hypotheses.back().cost < hypotheses[best].cost)) continue;
      best = hypotheses.size() - 1;
      inlier_ratio = static_cast<double>(hypotheses[best].inlier_idxs.size()) /
                     static_cast<double>(estimator.NumData());
    }
  };
  score_all(initial_models);
  std::mt19937 generator(options.random_seed);
  for (int i = 0; i < NumSamples(inlier_ratio, Estimator::kSampleSize, options); ++i) {
    score_all(estimator.Generate(&generator));
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; });
  return hypotheses;
}

// Fits a hypothesis to its inliers again while that lowers its cost and changes its inliers, at
// most `max_num_rounds` times. The Estimator also has
//   Refine(hypothesis)   the hypothesis of the model fitted to all its inliers
template <typename Estimator>
typename Estimator::Hypothesis RefineHypothesis(const Estimator& estimator, int max_num_rounds,
                                                typename Estimator::Hypothesis hypothesis) {
  for (int round = 0; round < max_num_rounds; ++round) {
    typename Estimator::Hypothesis refined = estimator.Refine(hypothesis);
    if (!(refined.cost < hypothesis.cost)) break;
    const bool has_settled = refined.inlier_idxs == hypothesis.inlier_idxs;
    hypothesis = std::move(refined);
    if (has_settled) break;
  }
  return hypothesis;
}

// At most `max_count` hypotheses by ascending cost, without those for which is_same(a, b) says that
// they are nearly the same as a better one.
template <typename Hypothesis, typename IsSame>
std::vector<Hypothesis> DistinctHypotheses(std::vector<Hypothesis> hypotheses,
                                           const IsSame& is_same, std::size_t max_count) {
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; });
  std::vector<Hypothesis> distinct;
  for (Hypothesis& hypothesis : hypotheses) {
    if (distinct.size() == max_count) break;
    if (std::none_of(distinct.begin(), distinct.end(),
                     [&](const Hypothesis& better) { return is_same(better, hypothesis); })) {
      distinct.push_back(std::move(hypothesis));
    }
  }
  return distinct;
}

}  // namespace velamap
