#include "reconstruct/evidence/line_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kNumSigmas = 3.0;
// A gap in the line costs at most this many steps for each place that it spans, however wide it is:
// the line may be torn there. This is more than the price of one end and less than the price of
// both.
constexpr double kTornSteps = 12.0;

// The price of leaving a marker out, in steps. A true marker between two others causes a detour of
// at most one step for each place (see the header). A true marker at an end is one step away from
// the next one; only the even spacing of the line can contradict it there, so its price is higher.
// If hardly any of its images shows the marker, the price is lower, but never so low that a line
// that turns back by less than 120 degrees loses a marker.
struct Price {
  double between, at_end;
};

Price PriceOf(Trust trust) {
  switch (trust) {
    case Trust::kSeldomSeen:
      return {0.5, 3.0};
    case Trust::kOftenMissed:
      return {1.25, 4.0};
    case Trust::kWellSeen:
      break;
  }
  return {1.5, 8.0};
}

int Gap(const LinePoint& a, const LinePoint& b) { return b.place_on_line - a.place_on_line; }

double Distance(const LinePoint& a, const LinePoint& b) {
  return (b.x_in_shape_m - a.x_in_shape_m).norm();
}

double StepBetween(const LinePoint& a, const LinePoint& b) { return Distance(a, b) / Gap(a, b); }

double LinkCost(const LinePoint& a, const LinePoint& b, double step_m) {
  return std::min(Distance(a, b), kTornSteps * step_m * Gap(a, b));
}

// The price of leaving out points[idx] between a and b. The uncertainty of the point lengthens both
// parts of the detour.
double CostBetween(const std::vector<LinePoint>& points, std::size_t a, std::size_t b,
                   std::size_t idx, double step_m) {
  const LinePoint& point = points[idx];
  return PriceOf(point.trust).between * step_m * Gap(points[a], points[b]) +
         2 * kNumSigmas * point.sigma_m;
}

// The price of leaving out points[idx] at an end of the line; `inner_idx` is next to it. If places
// between them are missing, only one of the steps may be unusually long.
double CostAtEnd(const std::vector<LinePoint>& points, std::size_t idx, std::size_t inner_idx,
                 double step_m) {
  const LinePoint& point = points[idx];
  const int num_usual_steps = std::abs(Gap(point, points[inner_idx])) - 1;
  return (PriceOf(point.trust).at_end + num_usual_steps) * step_m + kNumSigmas * point.sigma_m;
}

// Indices of the points on the cheapest way, ascending.
std::vector<std::size_t> CheapestWay(const std::vector<LinePoint>& points, double step_m) {
  const std::size_t num = points.size();
  std::vector<double> cost(num, 0.0);  // of the cheapest way to each point
  std::vector<std::size_t> previous(num, num);
  for (std::size_t j = 0; j < num; ++j) {
    for (std::size_t d = 0; d < j; ++d) cost[j] += CostAtEnd(points, d, d + 1, step_m);
    for (std::size_t i = j; i-- > 0;) {
      double by_way = cost[i] + LinkCost(points[i], points[j], step_m);
      for (std::size_t d = i + 1; d < j; ++d) by_way += CostBetween(points, i, j, d, step_m);
      if (by_way >= cost[j]) continue;
      cost[j] = by_way;
      previous[j] = i;
    }
  }
  std::size_t last = num - 1;
  double least = std::numeric_limits<double>::infinity(), beyond = 0.0;
  for (std::size_t j = num; j-- > 0;) {
    if (cost[j] + beyond < least) {
      least = cost[j] + beyond;
      last = j;
    }
    if (j > 0) beyond += CostAtEnd(points, j, j - 1, step_m);
  }
  std::vector<std::size_t> way;
  for (std::size_t j = last; j < num; j = previous[j]) way.push_back(j);
  std::reverse(way.begin(), way.end());
  return way;
}

std::vector<double> StepsAlong(const std::vector<LinePoint>& points,
                               const std::vector<std::size_t>& way) {
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < way.size(); ++i) {
    steps_m.push_back(StepBetween(points[way[i - 1]], points[way[i]]));
  }
  return steps_m;
}

double UsualStep(const std::vector<double>& steps_m) {
  return Median(steps_m) + kNumSigmas * RobustSigma(steps_m);
}

// Distances between neighbours and between next but one neighbours, ascending. Where some points
// are false markers, the small distances are between true ones.
std::vector<double> NearSteps(const std::vector<LinePoint>& points) {
  std::vector<double> steps_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(points.size(), i + 3); ++j) {
      steps_m.push_back(StepBetween(points[i], points[j]));
    }
  }
  std::sort(steps_m.begin(), steps_m.end());
  return steps_m;
}

}  // namespace

double EstimateStep(const std::vector<LinePoint>& points) {
  std::vector<std::size_t> all(points.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (points.size() < kMinPointsForStep) return UsualStep(StepsAlong(points, all));
  // The lower quartile excludes points that cannot be on the line at all; the rest gives the step.
  const std::vector<double> near_steps_m = NearSteps(points);
  const std::vector<double> kept_m =
      StepsAlong(points, CheapestWay(points, near_steps_m[near_steps_m.size() / 4]));
  return UsualStep(kept_m.empty() ? near_steps_m : kept_m);
}

double SmallestStep(const std::vector<LinePoint>& points) { return NearSteps(points).front(); }

bool AreWithinSteps(const LinePoint& a, const LinePoint& b, double step_m,
                    double num_uneven_steps) {
  return Distance(a, b) <= (Gap(a, b) + num_uneven_steps) * step_m;
}

std::vector<std::size_t> FindStrayPoints(const std::vector<LinePoint>& points, double step_m) {
  // Two false markers are hardly ever near each other, so a pair of points may be spaced less
  // evenly.
  constexpr double kUnevenInPiece = 3.0;
  if (points.size() < kMinPointsOnLine || !(step_m > 0)) return {};
  const std::vector<std::size_t> way = CheapestWay(points, step_m);
  const auto is_on_way = [&way](std::size_t idx) {
    return std::binary_search(way.begin(), way.end(), idx);
  };
  // Whether the kept points before and behind the point confirm it, or confirm a point beside it
  // that is left out as well.
  const auto is_confirmed = [&](std::size_t idx) {
    const LinePoint& point = points[idx];
    const auto after = std::lower_bound(way.begin(), way.end(), idx);
    return (after != way.end() && AreWithinSteps(point, points[*after], step_m)) ||
           (after != way.begin() && AreWithinSteps(points[*std::prev(after)], point, step_m)) ||
           (idx > 0 && !is_on_way(idx - 1) &&
            AreWithinSteps(points[idx - 1], point, step_m, kUnevenInPiece)) ||
           (idx + 1 < points.size() && !is_on_way(idx + 1) &&
            AreWithinSteps(point, points[idx + 1], step_m, kUnevenInPiece));
  };
  std::vector<std::size_t> stray_idxs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_on_way(i) && !is_confirmed(i)) stray_idxs.push_back(i);
  }
  if (2 * stray_idxs.size() >= points.size()) return {};
  return stray_idxs;
}

}  // namespace velamap
