// Finds the markers that do not stand on their line of the layout, as the cheapest way along the
// line. The way costs the distance from each marker that is kept to the next one, and a price, in
// steps of the line, for each marker that is left out.
//
// A step is the distance between neighbours. However cloth is bent, folded or rolled up, neighbours
// are never farther apart than along the cloth. A detour over a marker between two others is
// therefore never longer than twice the shorter of its two distances: on a line of equal steps, at
// most one step for each place from one of the others to the other. The prices are higher, except
// for markers that few of their images show, so that no bend costs a marker that is seen well. A
// line with uneven steps gets a larger step. Private to this folder.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

// How many of the images that could show a marker do so, compared with its neighbours.
enum class Trust { kSeldomSeen, kOftenMissed, kWellSeen };

// A marker that has a place, on its line.
struct LinePoint {
  int place_on_line = 0;  // counts all markers of the line, also missing ones
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();
  double sigma_m = 0.0;
  Trust trust = Trust::kWellSeen;
};

// With fewer markers, it cannot be told which one contradicts the others.
inline constexpr std::size_t kMinPointsOnLine = 3;
// With fewer markers, a step cannot be estimated if some of them may be false.
inline constexpr std::size_t kMinPointsForStep = 5;

// The median distance between neighbours for each place on the line, plus three times its robust
// sigma. `points` are in the order of the line, and at least kMinPointsOnLine.
double EstimateStep(const std::vector<LinePoint>& points);

// The smallest distance between neighbours, or next but one neighbours, for each place on the line.
// This is a lower bound of the step where too few markers are left to estimate it. Takes at least
// two points.
double SmallestStep(const std::vector<LinePoint>& points);

// Whether two points, given in the order of the line, are no farther apart than their places allow.
// One of the steps may be longer by `num_uneven_steps`.
bool AreWithinSteps(const LinePoint& a, const LinePoint& b, double step_m,
                    double num_uneven_steps = 0.5);

// Ascending indices of the points that do not belong on the line. Empty if these would be half of
// the points or more, because the layout is then likely to list the line wrongly. A point that its
// neighbours confirm stays: both pieces of a torn line are true.
std::vector<std::size_t> FindStrayPoints(const std::vector<LinePoint>& points, double step_m);

}  // namespace velamap
