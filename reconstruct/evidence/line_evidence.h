// Finds the markers that are not on their line of the layout: those that the cheapest path along
// the line leaves out. A path costs the distance from each kept marker to the next one, plus a
// price, in steps of the line, for each marker that is left out.
//
// A step is the distance between neighbours. However cloth is bent, folded or rolled up, neighbours
// are never farther apart than along the cloth. The detour over a marker between two others is
// therefore at most twice the shorter of its two distances, which on a line of equal steps is at
// most one step per place between the two others. The prices exceed this, so bent cloth never
// leaves out a true marker, unless few of the images that should show it do. A line with uneven
// steps gets a larger step.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

// How many of the images that should show a marker do, compared with its neighbours.
enum class Trust { kSeldomSeen, kOftenMissed, kWellSeen };

// A reconstructed marker of a line.
struct LinePoint {
  int place_on_line = 0;  // index among all markers of the line, including missing ones
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  double sigma_m = 0.0;  // in the least certain direction
  Trust trust = Trust::kWellSeen;
};

// With fewer markers, one cannot tell which of them contradicts the others.
inline constexpr std::size_t kMinPointsOnLine = 3;
// With fewer markers, a step cannot be estimated robustly against false ones.
inline constexpr std::size_t kMinPointsForStep = 5;

// The median distance, m, between neighbours per place on the line, plus three times its robust
// sigma. Takes at least two points, in the order of the line. From kMinPointsForStep points on,
// stray ones are left out.
double EstimateStep(const std::vector<LinePoint>& points);

// The smallest distance, m, between neighbours or next-but-one neighbours per place on the line. It
// is a lower bound of the step if there are too few markers for an estimate. Takes at least two
// points, in the order of the line.
double SmallestStep(const std::vector<LinePoint>& points);

// Whether two points, given in the order of the line, are no farther apart than the steps between
// their places plus `num_uneven_steps` steps for uneven spacing.
bool AreWithinSteps(const LinePoint& a, const LinePoint& b, double step_m,
                    double num_uneven_steps = 0.5);

// Whether `doubted` is too far from `confirmed` to be on a line with it. For lines on which only
// these two are left.
bool IsStrayFrom(const LinePoint& confirmed, const LinePoint& doubted, double step_m);

// Ascending indices of the points that are not on the line. Empty if these would be half of the
// points or more, because the line in the layout is then probably wrong. Points that their
// neighbours confirm are not stray, so both pieces of torn cloth are kept.
std::vector<std::size_t> FindStrayPoints(const std::vector<LinePoint>& points, double step_m);

}  // namespace velamap
