// Which markers do not stand on their line of the layout. The line is followed along the cloth: of
// all ways to leave markers out, the one is taken that costs least, where what is kept costs the
// length of the way from marker to marker and what is left out a price in steps of the line.
//
// A step is the distance of neighbours. On cloth that is bent, folded or rolled up in any way,
// neighbours are never farther apart than along the cloth, so a detour over a marker between two
// others is never longer than twice the shorter of its two distances: one step a marker on a line
// of equal steps. The prices are above that, so no bend costs a marker, and a line whose steps
// scatter has a larger step. Private to the evidence.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

// How often the images that could show a marker do, compared with its neighbours.
enum class Trust { kSeldomSeen, kOftenMissed, kWellSeen };

// A marker that has a place, on its line.
struct LinePoint {
  int place_on_line = 0;  // among all markers of the line, also those that are missing
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  double sigma_m = 0.0;
  Trust trust = Trust::kWellSeen;
};

// The fewest markers among which one can be found to contradict the others.
inline constexpr std::size_t kMinPointsOnLine = 3;
// The fewest from which a step can be estimated although some are false.
inline constexpr std::size_t kMinPointsForStep = 5;

// The median of the distances of neighbours for each place on the line, plus three times their
// robust sigma. `points` in the order of the line, at least kMinPointsOnLine.
double EstimateStep(const std::vector<LinePoint>& points);

// The smallest distance of neighbours, or of next but one neighbours, for each place on the line: a
// lower bound of the step where there are too few markers for an estimate. At least two points.
double SmallestStep(const std::vector<LinePoint>& points);

// Whether two points, in the order of the line, are no farther apart than its places are, one of
// which may be wider by `num_uneven_steps`.
bool AreAsFarAsTheLineSays(const LinePoint& a, const LinePoint& b, double step_m,
                           double num_uneven_steps = 0.5);

// The indices of the points that do not belong on the line, ascending. None if they were half of
// the points or more: the line is then listed wrongly, or not known well enough. A point stays that
// its neighbours confirm: where the line is torn, both of its pieces are true.
std::vector<std::size_t> FindStrayPoints(const std::vector<LinePoint>& points, double step_m);

}  // namespace velamap
