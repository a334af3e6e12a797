#include "exporters/sail/section_numbers.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "exporters/shape/units.h"

namespace velamap {
namespace {

constexpr int kNumSamples = 32;

// Parameter of the largest unsigned depth: the best of a grid, refined to the zero of the derivative.
double ParameterOfDepth(const SpaceCurve& curve, const Eigen::Vector3d& depth_direction) {
  constexpr int kNumBisections = 50;
  const Eigen::Vector3d first = EvaluateCurve(curve, 0.0);
  int best = 0;
  double best_depth = 0.0;
  for (int i = 1; i < kNumSamples; ++i) {
    const double t = static_cast<double>(i) / kNumSamples;
    const double depth = depth_direction.dot(EvaluateCurve(curve, t) - first);
    if (std::abs(depth) <= std::abs(best_depth)) continue;
    best = i;
    best_depth = depth;
  }
  const double sign = best_depth < 0 ? -1.0 : 1.0;
  const auto slope = [&](double t) {
    return sign * depth_direction.dot(EvaluateCurveJet(curve, t).x_t);
  };
  double low = std::max(0.0, (best - 1.0) / kNumSamples);
  double high = std::min(1.0, (best + 1.0) / kNumSamples);
  if (slope(low) <= 0 || slope(high) >= 0) return static_cast<double>(best) / kNumSamples;
  double t = 0.5 * (low + high);
  for (int step = 0; step < kNumBisections; ++step) {
    const CurveJet jet = EvaluateCurveJet(curve, t);
    const double first_derivative = sign * depth_direction.dot(jet.x_t);
    (first_derivative > 0 ? low : high) = t;
    // A Newton step if it stays between the bounds, otherwise bisection.
    const double newton = t - first_derivative / (sign * depth_direction.dot(jet.x_tt));
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - t) < 1e-14) return next;
    t = next;
  }
  return t;
}

}  // namespace

double AngleAboutDeg(const Eigen::Vector3d& up, const Eigen::Vector3d& a,
                     const Eigen::Vector3d& b) {
  const Eigen::Vector3d flat_a = a - up * up.dot(a), flat_b = b - up * up.dot(b);
  return kDegPerRad * std::atan2(up.dot(flat_a.cross(flat_b)), flat_a.dot(flat_b));
}

ProfileAxes ProfileAxesOf(const SpaceCurve& curve, const SectionAxes& axes) {
  const Eigen::Vector3d chord = EvaluateCurve(curve, 1.0) - EvaluateCurve(curve, 0.0);
  return {chord.normalized(), axes.leeward * axes.up.cross(chord).normalized()};
}

SectionNumbers ComputeNumbers(const SpaceCurve& curve, const SectionAxes& axes) {
  const ProfileAxes profile = ProfileAxesOf(curve, axes);
  const CurveJet first = EvaluateCurveJet(curve, 0.0);
  const CurveJet last = EvaluateCurveJet(curve, 1.0);
  const Eigen::Vector3d deepest =
      EvaluateCurve(curve, ParameterOfDepth(curve, profile.depth)) - first.x;
  const auto slope_deg = [&](const Eigen::Vector3d& tangent) {
    return kDegPerRad * std::atan2(profile.depth.dot(tangent), profile.chord.dot(tangent));
  };
  SectionNumbers numbers;
  numbers[kChord] = (last.x - first.x).norm();
  numbers[kCamber] = profile.depth.dot(deepest) / numbers[kChord];
  numbers[kDraftPosition] = profile.chord.dot(deepest) / numbers[kChord];
  numbers[kEntryAngle] = slope_deg(first.x_t);
  numbers[kExitAngle] = -slope_deg(last.x_t);
  numbers[kAzimuth] = axes.leeward * AngleAboutDeg(axes.up, axes.reference, profile.chord);
  return numbers;
}

double MeanDepth(const SpaceCurve& curve, const SectionAxes& axes) {
  const ProfileAxes profile = ProfileAxesOf(curve, axes);
  const Eigen::Vector3d first = EvaluateCurve(curve, 0.0);
  double sum_m = 0.0;
  for (int i = 1; i < kNumSamples; ++i) {
    sum_m += profile.depth.dot(EvaluateCurve(curve, static_cast<double>(i) / kNumSamples) - first);
  }
  return sum_m / kNumSamples;
}

}  // namespace velamap
