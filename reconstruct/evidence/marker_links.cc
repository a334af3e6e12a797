#include "reconstruct/evidence/marker_links.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "importer/base/statistics.h"
#include "importer/geometry/directions.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The smallest cosine between the normals of two neighbours.
constexpr double kSameFace = 0.5;
// Two markers are linked if their distance is at most this many times the larger of the distances
// to their nearest neighbours.
constexpr double kMaxLink = 1.75;
// The largest ratio between two consecutive steps of a row.
constexpr double kMaxStepRatio = 2.0;
constexpr double kMaxBend = 35.0 * kRadPerDeg, kMaxBendAtGap = 25.0 * kRadPerDeg;
// The largest gap in a row, in steps. Two missing markers leave a gap of three steps, and the steps
// are uneven.
constexpr double kMaxGap = 3.6;

bool FaceTheSameWay(const OrientedMarker& a, const OrientedMarker& b) {
  return a.normal.dot(b.normal) > kSameFace;
}

bool AreLike(double a, double b) { return std::max(a, b) < kMaxStepRatio * std::min(a, b); }

class Linker {
 public:
  explicit Linker(const std::vector<OrientedMarker>& markers) : markers_(markers) { Link(); }

  // Chains without gaps.
  std::vector<MarkerChain> Chains() {
    for (std::size_t i = 0; i < markers_.size(); ++i) Pair(i);
    std::vector<MarkerChain> chains;
    // The first pass starts at free ends, so that only rings remain for the second.
    for (const bool from_free_end : {true, false}) {
      for (std::size_t link = 0; link < links_.size(); ++link) {
        for (const std::size_t end : {std::size_t{0}, std::size_t{1}}) {
          if (used_[link] || (from_free_end && next_[link][end] != kNone)) continue;
          chains.push_back(Walk(link, end));
        }
      }
    }
    return chains;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  void Link() {
    const std::size_t num = markers_.size();
    std::vector<double> nearest(num, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < num; ++i) {
      for (std::size_t j = 0; j < num; ++j) {
        if (i == j || !FaceTheSameWay(markers_[i], markers_[j])) continue;
        nearest[i] = std::min(nearest[i], Distance(markers_[i], markers_[j]));
      }
    }
    links_of_.resize(num);
    for (std::size_t i = 0; i < num; ++i) {
      for (std::size_t j = i + 1; j < num; ++j) {
        if (!FaceTheSameWay(markers_[i], markers_[j])) continue;
        const double distance = Distance(markers_[i], markers_[j]);
        if (distance > kMaxLink * std::max(nearest[i], nearest[j]) || HasBetween(i, j)) continue;
        links_of_[i].push_back(links_.size());
        links_of_[j].push_back(links_.size());
        links_.push_back({i, j});
      }
    }
    next_.assign(links_.size(), {kNone, kNone});
    used_.assign(links_.size(), false);
  }

  bool HasBetween(std::size_t i, std::size_t j) const {
    const double distance = Distance(markers_[i], markers_[j]);
    for (std::size_t k = 0; k < markers_.size(); ++k) {
      if (k == i || k == j) continue;
      if (Distance(markers_[i], markers_[k]) < distance &&
          Distance(markers_[j], markers_[k]) < distance) {
        return true;
      }
    }
    return false;
  }

  std::size_t OtherEnd(std::size_t link, std::size_t marker) const {
    return links_[link][0] == marker ? links_[link][1] : links_[link][0];
  }

  Eigen::Vector3d Between(std::size_t from, std::size_t to) const {
    return markers_[to].center_m - markers_[from].center_m;
  }

  // Pairs the links at a marker that continue each other, the straightest pair first.
  void Pair(std::size_t marker) {
    struct Candidate {
      double bend;
      std::size_t a, b;
    };
    std::vector<Candidate> candidates;
    const std::vector<std::size_t>& links = links_of_[marker];
    for (std::size_t i = 0; i < links.size(); ++i) {
      for (std::size_t j = i + 1; j < links.size(); ++j) {
        const Eigen::Vector3d in = Between(OtherEnd(links[i], marker), marker);
        const Eigen::Vector3d out = Between(marker, OtherEnd(links[j], marker));
        const double bend = AngleBetween(in, out);
        if (bend > kMaxBend || !AreLike(in.norm(), out.norm())) continue;
        candidates.push_back({bend, links[i], links[j]});
      }
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.bend < b.bend; });
    for (const Candidate& candidate : candidates) {
      std::size_t& after_a = next_[candidate.a][links_[candidate.a][0] == marker ? 0 : 1];
      std::size_t& after_b = next_[candidate.b][links_[candidate.b][0] == marker ? 0 : 1];
      if (after_a != kNone || after_b != kNone) continue;
      after_a = candidate.b;
      after_b = candidate.a;
    }
  }

  // Follows a link from its marker at `end`, and then the links that continue it.
  MarkerChain Walk(std::size_t link, std::size_t end) {
    MarkerChain chain{links_[link][end]};
    std::set<std::size_t> seen{chain.front()};
    while (link != kNone && !used_[link]) {
      used_[link] = true;
      const std::size_t marker = OtherEnd(link, chain.back());
      if (!seen.insert(marker).second) break;
      chain.push_back(marker);
      link = next_[link][links_[link][0] == marker ? 0 : 1];
    }
    return chain;
  }

  const std::vector<OrientedMarker>& markers_;
  std::vector<std::array<std::size_t, 2>> links_;
  std::vector<std::vector<std::size_t>> links_of_;  // by marker
  std::vector<std::array<std::size_t, 2>> next_;    // by link and end: the link that continues it
  std::vector<bool> used_;                          // by link
};

// Where the next marker of a row is missing, a marker of the neighbouring row can seem to continue
// it. Such a marker is off the straight line through the last two, `a` and `b`, by most of a step.
bool IsBeside(const OrientedMarker& a, const OrientedMarker& b, const OrientedMarker& next) {
  constexpr double kMaxSidestep = 0.6;  // of a step
  const Eigen::Vector3d step = b.center_m - a.center_m;
  return step.normalized().cross(next.center_m - b.center_m).norm() > kMaxSidestep * step.norm();
}

void TrimEnd(const std::vector<OrientedMarker>& markers, MarkerChain* chain) {
  const std::size_t num = chain->size();
  if (num < 3) return;
  if (IsBeside(markers[(*chain)[num - 3]], markers[(*chain)[num - 2]], markers[chain->back()])) {
    chain->pop_back();
  }
}

MarkerChain Reversed(MarkerChain chain) {
  std::reverse(chain.begin(), chain.end());
  return chain;
}

// The largest angle, rad, by which the row bends if `b` continues the end of `a`, or nothing if `b`
// does not continue it.
std::optional<double> BendAtGap(const std::vector<OrientedMarker>& markers, const MarkerChain& a,
                                const MarkerChain& b) {
  if (!FaceTheSameWay(markers[a.back()], markers[b.front()])) return std::nullopt;
  const Eigen::Vector3d gap = markers[b.front()].center_m - markers[a.back()].center_m;
  const double step = SpacingOf(markers, a);
  if (gap.norm() > kMaxGap * step) return std::nullopt;
  if (IsBeside(markers[a[a.size() - 2]], markers[a.back()], markers[b.front()])) {
    return std::nullopt;
  }
  double bend = AngleBetween(markers[a.back()].center_m - markers[a[a.size() - 2]].center_m, gap);
  if (b.size() > 1) {
    if (!AreLike(step, SpacingOf(markers, b))) return std::nullopt;
    bend = std::max(bend, AngleBetween(gap, markers[b[1]].center_m - markers[b.front()].center_m));
  }
  if (bend > kMaxBendAtGap) return std::nullopt;
  return bend;
}

// Joins the two chains that continue each other with the smallest bend. Returns false if there are
// none.
bool BridgeOneGap(const std::vector<OrientedMarker>& markers, std::vector<MarkerChain>* chains) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t best_a = 0, best_b = 0;
  MarkerChain joined;
  for (std::size_t i = 0; i < chains->size(); ++i) {
    for (std::size_t j = 0; j < chains->size(); ++j) {
      if (i == j || (*chains)[i].size() < 3 || ShareMarkers((*chains)[i], (*chains)[j])) continue;
      for (const MarkerChain& a : {(*chains)[i], Reversed((*chains)[i])}) {
        for (const MarkerChain& b : {(*chains)[j], Reversed((*chains)[j])}) {
          const auto bend = BendAtGap(markers, a, b);
          if (!bend || *bend >= least) continue;
          least = *bend;
          best_a = i;
          best_b = j;
          joined = a;
          joined.insert(joined.end(), b.begin(), b.end());
        }
      }
    }
  }
  if (joined.empty()) return false;
  (*chains)[best_a] = std::move(joined);
  chains->erase(chains->begin() + static_cast<std::ptrdiff_t>(best_b));
  return true;
}

}  // namespace

std::vector<OrientedMarker> OrientedMarkers(const ShapePoints& shape) {
  std::vector<OrientedMarker> markers;
  for (const auto& [marker_id, x] : shape) {
    OrientedMarker marker;
    marker.marker_id = marker_id;
    marker.center_m = x[0];
    marker.right = (x[2] - x[1] + x[3] - x[4]).normalized();
    marker.normal = marker.right.cross(x[1] - x[4] + x[2] - x[3]).normalized();
    marker.up = marker.normal.cross(marker.right);
    markers.push_back(marker);
  }
  return markers;
}

bool ShareMarkers(const MarkerChain& a, const MarkerChain& b) {
  return std::any_of(a.begin(), a.end(), [&b](std::size_t marker) {
    return std::find(b.begin(), b.end(), marker) != b.end();
  });
}

double Distance(const OrientedMarker& a, const OrientedMarker& b) {
  return (a.center_m - b.center_m).norm();
}

double SpacingOf(const std::vector<OrientedMarker>& markers, const MarkerChain& chain) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    steps.push_back(Distance(markers[chain[i - 1]], markers[chain[i]]));
  }
  return Median(std::move(steps));
}

std::vector<MarkerChain> FindChains(const std::vector<OrientedMarker>& markers) {
  std::vector<MarkerChain> chains = Linker(markers).Chains();
  for (MarkerChain& chain : chains) {
    TrimEnd(markers, &chain);
    chain = Reversed(std::move(chain));
    TrimEnd(markers, &chain);
  }
  std::set<std::size_t> on_rows;
  for (const MarkerChain& chain : chains) {
    if (chain.size() >= 3) on_rows.insert(chain.begin(), chain.end());
  }
  // A single marker can be the end of a row, beyond a gap.
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (on_rows.count(i) == 0) chains.push_back({i});
  }
  while (BridgeOneGap(markers, &chains)) {
  }
  chains.erase(std::remove_if(chains.begin(), chains.end(),
                              [](const MarkerChain& chain) { return chain.size() < 2; }),
               chains.end());
  return chains;
}

}  // namespace velamap
