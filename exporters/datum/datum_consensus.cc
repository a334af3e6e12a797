#include "exporters/datum/datum_consensus.h"

#include <algorithm>
#include <set>
#include <utility>

#include "exporters/datum/datum_fit.h"
#include "importer/geometry/ransac.h"

namespace velamap {
namespace {

// Whether the set determines a pose. `known_from_centred` is an approximation of it.
bool Determines(const DatumPoints& points, const PointSet& set, const Rigid3& known_from_centred) {
  return NumCoordinates(points, set) >= kNumPoseParameters &&
         UndeterminedMotions(points, set, known_from_centred).empty();
}

struct DatumHypothesis {
  DatumPose pose;
  double cost = 0.0;  // truncated sum of squared sigmas
  PointSet inlier_idxs;
};

// The estimator for Ransac() in ransac.h.
class DatumConsensus {
 public:
  struct Model {
    PointSet sample;
    Rigid3 known_from_centred;
  };
  using Hypothesis = DatumHypothesis;
  static constexpr int kSampleSize = 3;  // a sample has more points if coordinates are missing

  DatumConsensus(const DatumPoints& points, const PointSet& candidates)
      : points_(points), candidates_(candidates) {}

  std::size_t NumData() const { return candidates_.size(); }

  std::vector<Model> Generate(std::mt19937* generator) const {
    PointSet rest = candidates_, sample;
    while (!rest.empty()) {
      const std::size_t chosen = RandomIndex(generator, rest.size());
      sample.insert(std::lower_bound(sample.begin(), sample.end(), rest[chosen]), rest[chosen]);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(chosen));
      if (sample.size() < kSampleSize || NumCoordinates(points_, sample) < kNumPoseParameters) {
        continue;
      }
      std::vector<Model> models;
      for (const DatumPose& pose : FindPoses(points_, sample)) {
        if (Determines(points_, sample, pose.known_from_centred)) {
          models.push_back({sample, pose.known_from_centred});
        }
      }
      if (!models.empty()) return models;
    }
    return {};
  }

  DatumHypothesis Score(const Model& model) const {
    DatumHypothesis hypothesis{
        AdjustPose(points_, model.sample, model.known_from_centred), 0.0, {}};
    const std::vector<double> sigmas_off =
        BaardaStatistics(points_, model.sample, hypothesis.pose.known_from_centred);
    for (const std::size_t i : candidates_) {
      const double sigmas = sigmas_off[i];
      hypothesis.cost += std::min(sigmas * sigmas, kMaxDatumSigmas * kMaxDatumSigmas);
      if (sigmas <= kMaxDatumSigmas) hypothesis.inlier_idxs.push_back(i);
    }
    return hypothesis;
  }

 private:
  const DatumPoints& points_;
  const PointSet& candidates_;
};

// Repeatedly removes the point that contradicts the others most, then adds the candidates that
// agree with the rest. A removed point is not added again, so this ends.
DatumAgreement Settle(const DatumPoints& points, const PointSet& candidates, PointSet set,
                      DatumPose pose) {
  std::set<std::size_t> left_out;
  std::vector<double> sigmas;
  while (set.size() >= DatumConsensus::kSampleSize) {
    pose = AdjustPose(points, set, pose.known_from_centred);
    sigmas = BaardaStatistics(points, set, pose.known_from_centred);
    const auto worst = std::max_element(set.begin(), set.end(), [&](std::size_t a, std::size_t b) {
      return sigmas[a] < sigmas[b];
    });
    if (sigmas[*worst] > kMaxDatumSigmas) {
      left_out.insert(*worst);
      set.erase(worst);
      continue;
    }
    PointSet more = set;
    for (const std::size_t i : candidates) {
      const bool is_in = std::binary_search(set.begin(), set.end(), i);
      if (!is_in && left_out.count(i) == 0 && sigmas[i] <= kMaxDatumSigmas) more.push_back(i);
    }
    if (more.size() == set.size()) break;
    std::sort(more.begin(), more.end());
    set = std::move(more);
  }
  return {std::move(set), pose, std::move(sigmas)};
}

bool IsSupported(const DatumPoints& points, const PointSet& candidates,
                 const DatumAgreement& agreement) {
  const PointSet& used = agreement.used;
  const int redundancy = NumCoordinates(points, used) - kNumPoseParameters;
  // Without redundancy the points cannot check each other, but a pose that fits them all need not
  // exist, for example if their distances are wrong.
  const bool fits = redundancy > 0 || (used == candidates && agreement.pose.squared_sigmas <=
                                                                 kMaxDatumSigmas * kMaxDatumSigmas);
  return fits && 2 * used.size() > candidates.size() &&
         Determines(points, used, agreement.pose.known_from_centred);
}

}  // namespace

std::optional<DatumAgreement> FindAgreement(const DatumPoints& points, const PointSet& candidates) {
  DatumAgreement agreement;
  agreement.pose =
      AdjustPose(points, candidates, FindPoses(points, candidates).front().known_from_centred);
  agreement.sigmas_off = BaardaStatistics(points, candidates, agreement.pose.known_from_centred);
  agreement.used = candidates;
  const bool all_agree = std::all_of(candidates.begin(), candidates.end(), [&](std::size_t i) {
    return agreement.sigmas_off[i] <= kMaxDatumSigmas;
  });
  if (!all_agree) {
    const std::vector<DatumHypothesis> hypotheses =
        Ransac(RansacOptions(), DatumConsensus(points, candidates));
    if (hypotheses.empty()) return std::nullopt;
    agreement = Settle(points, candidates, hypotheses.front().inlier_idxs, hypotheses.front().pose);
  }
  if (!IsSupported(points, candidates, agreement)) return std::nullopt;
  return agreement;
}

}  // namespace velamap
