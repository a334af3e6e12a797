#include "reconstruct/evidence/line_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kNumSigmas = 3.0;
// A gap in the line costs at most this many steps per place that it spans, because the cloth may be
// torn there. The limit is between the price of one marker at an end and the price of two.
constexpr double kTornSteps = 12.0;

// The price of leaving a marker out, in steps. A true marker between two others causes a detour of
// at most one step per place (see the header). At an end there is no detour: only the distance to
// the next marker, which is about one step, can contradict a marker, so its price is higher.
// Markers that few of their images show have a lower price, which is still high enough to keep a
// marker where the line bends by less than 120 degrees.
struct Price {
  double between, at_end;  // `between` is per place from the kept marker before to the one behind
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

// The price of leaving out points[idx] between a and b, m. The uncertainty of the point can
// lengthen both parts of the detour.
double CostBetween(const std::vector<LinePoint>& points, std::size_t a, std::size_t b,
                   std::size_t idx, double step_m) {
  const LinePoint& point = points[idx];
  return PriceOf(point.trust).between * step_m * Gap(points[a], points[b]) +
         2 * kNumSigmas * point.sigma_m;
}

// The price of leaving out a point at an end of the line, m. `inner` is its neighbour. Each missing
// place between the two adds one step, so that only one of the steps may be unusually long.
double CostAtEnd(const LinePoint& point, const LinePoint& inner, double step_m) {
  const int num_usual_steps = std::abs(Gap(point, inner)) - 1;
  return (PriceOf(point.trust).at_end + num_usual_steps) * step_m + kNumSigmas * point.sigma_m;
}

// Ascending indices of the points on the cheapest path, by dynamic programming.
std::vector<std::size_t> CheapestPath(const std::vector<LinePoint>& points, double step_m) {
  const std::size_t num = points.size();
  std::vector<double> cost(num, 0.0);  // of the cheapest path that ends at each point
  std::vector<std::size_t> previous(num, num);
  for (std::size_t j = 0; j < num; ++j) {
    for (std::size_t d = 0; d < j; ++d) cost[j] += CostAtEnd(points[d], points[d + 1], step_m);
    for (std::size_t i = j; i-- > 0;) {
      double by_path = cost[i] + LinkCost(points[i], points[j], step_m);
      for (std::size_t d = i + 1; d < j; ++d) by_path += CostBetween(points, i, j, d, step_m);
      if (by_path >= cost[j]) continue;
      cost[j] = by_path;
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
    if (j > 0) beyond += CostAtEnd(points[j], points[j - 1], step_m);
  }
  std::vector<std::size_t> path;
  for (std::size_t j = last; j < num; j = previous[j]) path.push_back(j);
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<double> StepsAlong(const std::vector<LinePoint>& points,
                               const std::vector<std::size_t>& path) {
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < path.size(); ++i) {
    steps_m.push_back(StepBetween(points[path[i - 1]], points[path[i]]));
  }
  return steps_m;
}

double UsualStep(const std::vector<double>& steps_m) {
  return Median(steps_m) + kNumSigmas * RobustSigma(steps_m);
}

// Distances per place between neighbours and next-but-one neighbours, ascending. If some of the
// points are false markers, the small distances are those between true ones.
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
  // With the lower quartile as a first step, the path leaves out gross outliers. The remaining
  // points give the step.
  const std::vector<double> near_steps_m = NearSteps(points);
  const std::vector<double> kept_m =
      StepsAlong(points, CheapestPath(points, near_steps_m[near_steps_m.size() / 4]));
  return UsualStep(kept_m.empty() ? near_steps_m : kept_m);
}

double SmallestStep(const std::vector<LinePoint>& points) { return NearSteps(points).front(); }

bool AreWithinSteps(const LinePoint& a, const LinePoint& b, double step_m,
                    double num_uneven_steps) {
  return Distance(a, b) <= (Gap(a, b) + num_uneven_steps) * step_m;
}

bool IsStrayFrom(const LinePoint& confirmed, const LinePoint& doubted, double step_m) {
  return Distance(confirmed, doubted) >
         CostAtEnd(doubted, confirmed, step_m) + kNumSigmas * confirmed.sigma_m;
}

std::vector<std::size_t> FindStrayPoints(const std::vector<LinePoint>& points, double step_m) {
  // Two false markers are hardly ever near each other, so neighbouring points that are both left
  // out confirm each other at a larger distance.
  constexpr double kUnevenInPiece = 3.0;
  if (points.size() < kMinPointsOnLine || !(step_m > 0)) return {};
  const std::vector<std::size_t> path = CheapestPath(points, step_m);
  const auto is_on_path = [&path](std::size_t idx) {
    return std::binary_search(path.begin(), path.end(), idx);
  };
  // Whether the nearest kept point on either side confirms the point, or a neighbour that is left
  // out as well does.
  const auto is_confirmed = [&](std::size_t idx) {
    const LinePoint& point = points[idx];
    const auto after = std::lower_bound(path.begin(), path.end(), idx);
    return (after != path.end() && AreWithinSteps(point, points[*after], step_m)) ||
           (after != path.begin() && AreWithinSteps(points[*std::prev(after)], point, step_m)) ||
           (idx > 0 && !is_on_path(idx - 1) &&
            AreWithinSteps(points[idx - 1], point, step_m, kUnevenInPiece)) ||
           (idx + 1 < points.size() && !is_on_path(idx + 1) &&
            AreWithinSteps(point, points[idx + 1], step_m, kUnevenInPiece));
  };
  std::vector<std::size_t> stray_idxs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_on_path(i) && !is_confirmed(i)) stray_idxs.push_back(i);
  }
  if (2 * stray_idxs.size() >= points.size()) return {};
  return stray_idxs;
}

}  // namespace velamap
