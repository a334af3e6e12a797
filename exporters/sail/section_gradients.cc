#include "exporters/sail/section_gradients.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace velamap {
namespace {

constexpr double kStep_m = 1e-5;

// Central differences of function(centers, index) with respect to every coordinate of the listed
// markers.
template <typename Function>
Eigen::MatrixXd Differentiate(const CenterSet& centers, const std::vector<int>& indices,
                              const Function& function) {
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(kNumSectionNumbers, centers.x_m.size());
  const auto has_sigma = [&](int index) {
    return centers.has_sigma[static_cast<std::size_t>(index)];
  };
  if (std::none_of(indices.begin(), indices.end(), has_sigma)) {
    gradient.setConstant(std::numeric_limits<double>::quiet_NaN());
    return gradient;
  }
  CenterSet moved = centers;
  for (const int index : indices) {
    for (int axis = 0; axis < 3; ++axis) {
      double& coordinate = moved.x_m(axis, index);
      const double x = coordinate;
      coordinate = x + kStep_m;
      const SectionNumbers above = function(moved, index);
      coordinate = x - kStep_m;
      const SectionNumbers below = function(moved, index);
      coordinate = x;
      gradient.col(3 * index + axis) = (above - below) / (2 * kStep_m);
    }
  }
  return gradient;
}

}  // namespace

NumbersWithGradient NumbersOfLine(const PartContext& context, const LineCurve& line) {
  return {ComputeNumbers(line.fit.curve, context.axes),
          Differentiate(context.centers, line.indices, [&](const CenterSet& moved, int) {
            return ComputeNumbers(line.Refit(moved), context.axes);
          })};
}

std::vector<Eigen::Matrix3Xd> SampleLines(const std::vector<LineCurve>& lines) {
  std::vector<Eigen::Matrix3Xd> samples;
  for (const LineCurve& line : lines) samples.push_back(SampleForCut(line.fit.curve));
  return samples;
}

NumbersWithGradient NumbersOfCut(const PartContext& context, const SpaceCurve& cut,
                                 double height_m) {
  const std::vector<LineCurve>& lines = context.curves.lines;
  const std::vector<Eigen::Matrix3Xd> samples = SampleLines(lines);
  std::set<int> indices;
  for (const LineCurve& line : lines) indices.insert(line.indices.begin(), line.indices.end());
  const auto numbers = [&](const CenterSet& moved, int index) -> SectionNumbers {
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
  return {ComputeNumbers(cut, context.axes),
          Differentiate(context.centers, {indices.begin(), indices.end()}, numbers)};
}

NumbersWithGradient NumbersOfBoom(const PartContext& context, const Boom& boom) {
  const auto azimuth = [&](const CenterSet& centers, int) -> SectionNumbers {
    SectionNumbers numbers = SectionNumbers::Zero();
    numbers[kAzimuth] =
        context.axes.leeward *
        AngleAboutDeg(context.axes.up, context.axes.reference,
                      centers.x_m.col(boom.last_idx) - centers.x_m.col(boom.first_idx));
    return numbers;
  };
  return {azimuth(context.centers, 0),
          Differentiate(context.centers, {boom.first_idx, boom.last_idx}, azimuth)};
}

std::optional<double> SigmaOfGradient(const CenterSet& centers,
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

}  // namespace velamap
