#include "exporters/sail/section_numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <Eigen/Geometry>

#include "exporters/formats/surface_spline.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr int kNumSamples = 32;

constexpr double kStep_m = 1e-5;

// Length of the curve, m.
double Girth(const SpaceCurve& curve) {
  double length_m = 0.0;
  for (const QuadratureNode& node : SpanQuadrature(curve.knots)) {
    length_m += node.weight * EvaluateCurveJet(curve, node.parameter).x_t.norm();
  }
  return length_m;
}

// Angle from a to b about up, -180..180.
double AngleAboutDeg(const Eigen::Vector3d& up, const Eigen::Vector3d& a,
                     const Eigen::Vector3d& b) {
  const Eigen::Vector3d flat_a = a - up * up.dot(a), flat_b = b - up * up.dot(b);
  return kDegPerRad * std::atan2(up.dot(flat_a.cross(flat_b)), flat_a.dot(flat_b));
}

SectionNumbers ComputeNumbers(const SpaceCurve& curve, const SectionAxes& axes) {
  const ProfileAxes profile = ProfileAxesOf(curve, axes);
  const CurveJet first = EvaluateCurveJet(curve, 0.0);
  const CurveJet last = EvaluateCurveJet(curve, 1.0);
  const Eigen::Vector3d deepest =
      EvaluateCurve(curve, FarthestParameter(curve, profile.depth)) - first.x;
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
  numbers[kLeechAzimuth] = axes.leeward * AngleAboutDeg(axes.up, axes.reference, last.x_t);
  numbers[kGirth] = Girth(curve);
  return numbers;
}

// NumbersWithGradient::beyond_sigmas. Beyond an offset a, a change c of the curvature turns the
// curve by c a^2 / 2; the effect on the numbers that are lengths is far below their noise.
SectionNumbers BeyondSigmas(const PartContext& context, const LineCurve& line) {
  const double change =
      CurvatureChange(line.fit.curve, ProfileAxesOf(line.curve, context.axes).depth);
  const CurveEnds ends = line.Ends();
  SectionNumbers sigmas = SectionNumbers::Zero();
  sigmas[kEntryAngle] = kDegPerRad * change * ends.before_m * ends.before_m / 2;
  sigmas[kExitAngle] = sigmas[kLeechAzimuth] =
      kDegPerRad * change * ends.after_m * ends.after_m / 2;
  return sigmas;
}

}  // namespace

// The best of a grid, refined to the zero of the derivative.
double FarthestParameter(const SpaceCurve& curve, const Eigen::Vector3d& direction) {
  constexpr int kNumBisections = 50;
  const Eigen::Vector3d first = EvaluateCurve(curve, 0.0);
  int best = 0;
  double farthest = 0.0;
  for (int i = 1; i < kNumSamples; ++i) {
    const double t = static_cast<double>(i) / kNumSamples;
    const double distance = direction.dot(EvaluateCurve(curve, t) - first);
    if (std::abs(distance) <= std::abs(farthest)) continue;
    best = i;
    farthest = distance;
  }
  const double sign = farthest < 0 ? -1.0 : 1.0;
  const auto slope = [&](double t) { return sign * direction.dot(EvaluateCurveJet(curve, t).x_t); };
  double low = std::max(0.0, (best - 1.0) / kNumSamples);
  double high = std::min(1.0, (best + 1.0) / kNumSamples);
  if (slope(low) <= 0 || slope(high) >= 0) return static_cast<double>(best) / kNumSamples;
  double t = 0.5 * (low + high);
  for (int step = 0; step < kNumBisections; ++step) {
    const CurveJet jet = EvaluateCurveJet(curve, t);
    const double first_derivative = sign * direction.dot(jet.x_t);
    (first_derivative > 0 ? low : high) = t;
    // A Newton step if it stays between the bounds, otherwise bisection.
    const double newton = t - first_derivative / (sign * direction.dot(jet.x_tt));
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - t) < 1e-14) return next;
    t = next;
  }
  return t;
}

Eigen::MatrixXd Differentiate(const MarkerCenters& centers, const std::vector<int>& indices,
                              Eigen::Index num_numbers, const NumbersFunction& function) {
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(num_numbers, centers.x_m.size());
  const auto has_sigma = [&](int index) {
    return centers.has_sigma[static_cast<std::size_t>(index)];
  };
  if (std::none_of(indices.begin(), indices.end(), has_sigma)) {
    gradient.setConstant(std::numeric_limits<double>::quiet_NaN());
    return gradient;
  }
  MarkerCenters moved = centers;
  for (const int index : indices) {
    for (int axis = 0; axis < 3; ++axis) {
      double& coordinate = moved.x_m(axis, index);
      const double x = coordinate;
      coordinate = x + kStep_m;
      const Eigen::VectorXd above = function(moved, index);
      coordinate = x - kStep_m;
      const Eigen::VectorXd below = function(moved, index);
      coordinate = x;
      gradient.col(3 * index + axis) = (above - below) / (2 * kStep_m);
    }
  }
  return gradient;
}

ProfileAxes ProfileAxesOf(const SpaceCurve& curve, const SectionAxes& axes) {
  const Eigen::Vector3d chord = ChordOf(curve);
  return {chord.normalized(), axes.leeward * axes.up.cross(chord).normalized()};
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

NumbersWithGradient NumbersOfLine(const PartContext& context, const LineCurve& line) {
  return {ComputeNumbers(line.curve, context.axes),
          Differentiate(context.centers, line.indices, kNumSectionNumbers,
                        [&](const MarkerCenters& moved, int) {
                          return ComputeNumbers(line.Refit(moved), context.axes);
                        }),
          BeyondSigmas(context, line)};
}

std::vector<Eigen::Matrix3Xd> SampleLines(const std::vector<LineCurve>& lines) {
  std::vector<Eigen::Matrix3Xd> samples;
  for (const LineCurve& line : lines) samples.push_back(SampleForCut(line.curve));
  return samples;
}

NumbersWithGradient NumbersOfCut(const PartContext& context, const SpaceCurve& cut,
                                 double height_m) {
  const std::vector<LineCurve>& lines = context.curves.lines;
  const std::vector<Eigen::Matrix3Xd> samples = SampleLines(lines);
  std::set<int> indices;
  for (const LineCurve& line : lines) indices.insert(line.indices.begin(), line.indices.end());
  const auto numbers = [&](const MarkerCenters& moved, int index) -> SectionNumbers {
    std::vector<Eigen::Matrix3Xd> moved_samples = samples;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::vector<int>& on_line = lines[i].indices;
      if (std::find(on_line.begin(), on_line.end(), index) != on_line.end()) {
        moved_samples[i] = SampleForCut(lines[i].Refit(moved));
      }
    }
    const HeightCut moved_cut = CutAtHeight(moved_samples, context.axes.up, height_m);
    // At the end of the lines, a step may leave them; there is no derivative then.
    if (!moved_cut.curve) {
      return SectionNumbers::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    return ComputeNumbers(*moved_cut.curve, context.axes);
  };
  SectionNumbers beyond_sigmas = SectionNumbers::Zero();
  for (const LineCurve& line : lines) {
    beyond_sigmas = beyond_sigmas.cwiseMax(BeyondSigmas(context, line));
  }
  return {
      ComputeNumbers(cut, context.axes),
      Differentiate(context.centers, {indices.begin(), indices.end()}, kNumSectionNumbers, numbers),
      beyond_sigmas};
}

NumbersWithGradient NumbersOfPair(const PartContext& context, const MarkerPair& pair) {
  const auto azimuth = [&](const MarkerCenters& centers, int) -> SectionNumbers {
    SectionNumbers numbers = SectionNumbers::Zero();
    numbers[kAzimuth] =
        context.axes.leeward *
        AngleAboutDeg(context.axes.up, context.axes.reference,
                      centers.x_m.col(pair.last_idx) - centers.x_m.col(pair.first_idx));
    return numbers;
  };
  return {
      azimuth(context.centers, 0),
      Differentiate(context.centers, {pair.first_idx, pair.last_idx}, kNumSectionNumbers, azimuth),
      SectionNumbers::Zero()};
}

std::optional<double> SigmaOfGradient(const MarkerCenters& centers,
                                      const Eigen::RowVectorXd& gradient) {
  for (std::size_t i = 0; i < centers.has_sigma.size(); ++i) {
    const auto by_marker = gradient.segment<3>(static_cast<Eigen::Index>(3 * i));
    if (!by_marker.allFinite() || (!centers.has_sigma[i] && !by_marker.isZero(0.0))) {
      return std::nullopt;
    }
  }
  const double variance = gradient * centers.covariance_m2 * gradient.transpose();
  return std::sqrt(std::max(0.0, variance));
}

std::optional<double> SigmaOf(SectionNumber number, const MarkerCenters& centers,
                              const NumbersWithGradient& own,
                              const NumbersWithGradient* reference) {
  Eigen::RowVectorXd gradient = own.gradient.row(number);
  if (reference != nullptr) gradient -= reference->gradient.row(number);
  const std::optional<double> by_markers = SigmaOfGradient(centers, gradient);
  if (!by_markers) return std::nullopt;
  const bool is_itself = reference != nullptr && gradient.isZero(0.0);
  const double of_own = is_itself ? 0.0 : own.beyond_sigmas[number];
  const double of_reference =
      is_itself || reference == nullptr ? 0.0 : reference->beyond_sigmas[number];
  return std::hypot(*by_markers, of_own, of_reference);
}

}  // namespace velamap
