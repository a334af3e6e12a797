#include "importer/formation/edge_shift.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "importer/pattern/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

// Least squares of the residuals at inner edges on their derivative by the shift of edges.
struct ShiftSums {
  double by_residual = 0.0, squares = 0.0;

  void Add(double derivative, double residual, double weight) {
    by_residual += weight * derivative * residual;
    squares += weight * derivative * derivative;
  }
  ShiftSums& operator+=(const ShiftSums& other) {
    by_residual += other.by_residual;
    squares += other.squares;
    return *this;
  }
  double shift_blurs() const { return squares > 0 ? by_residual / squares : 0.0; }
};

// Sums over the edges that the rows of the image cross, and over those that its columns cross.
struct SampleShift {
  ShiftSums across_rows, across_columns;
};

SampleShift ShiftOf(const FittedSample& sample) {
  constexpr double kStepBlurs = 0.04;
  const PatternProblem& problem = sample.problem;
  PatternModel shifted = problem.model;
  shifted.edge_shift_blurs += kStepBlurs;
  const PatternPicture picture(problem.model, sample.minimum.parameters);
  const PatternPicture moved_picture(shifted, sample.minimum.parameters);
  const cv::Point patch_from_box = problem.box.tl() - problem.patch.origin_px;
  SampleShift shift;
  PatternPixels pixels, moved;
  for (const SamplePlace& place : sample.places) {
    if (place.is_at_outline_corner || IsClipped(sample, place)) continue;
    const Floats x = AllLanes(place.in_box.x + problem.box.x - problem.model.center_px.x());
    const Floats y = AllLanes(place.in_box.y + problem.box.y - problem.model.center_px.y());
    if (!picture.IsAmongInnerCells(x, y)[0]) continue;
    picture.At(x, y, &pixels);
    moved_picture.At(x, y, &moved);
    const double residual =
        problem.patch.values.at<float>(place.in_box + patch_from_box) - pixels.gray[0];
    const double by_shift = (moved.gray[0] - pixels.gray[0]) / kStepBlurs;
    // The shares of the corners add up to one, so that their derivatives add up to the slope.
    double by_x = 0.0, by_y = 0.0;
    for (std::size_t i = 0; i < 2 * kNumCorners; i += 2) {
      by_x += pixels.jacobian[P::kCorners + i][0];
      by_y += pixels.jacobian[P::kCorners + i + 1][0];
    }
    const double squared_slope = by_x * by_x + by_y * by_y;
    if (!(squared_slope > 0)) continue;
    shift.across_rows.Add(by_shift, residual, by_x * by_x / squared_slope);
    shift.across_columns.Add(by_shift, residual, by_y * by_y / squared_slope);
  }
  return shift;
}

}  // namespace

EdgeShift InnerEdgeShift(const FormationState& state) {
  std::vector<ShiftSums> samples;
  ShiftSums across_rows, across_columns;
  for (const FittedSample& sample : state.samples) {
    if (sample.residuals.empty()) continue;
    const SampleShift shift = ShiftOf(sample);
    across_rows += shift.across_rows;
    across_columns += shift.across_columns;
    samples.push_back(shift.across_rows);
    samples.back() += shift.across_columns;
  }
  ShiftSums all = across_rows;
  all += across_columns;
  if (samples.size() < 2 || !(all.squares > 0)) return {};
  const double mean = all.shift_blurs();
  double scatter = 0.0;
  for (const ShiftSums& sample : samples) {
    const double deviation = sample.by_residual - sample.squares * mean;
    scatter += deviation * deviation;
  }
  const auto count = static_cast<double>(samples.size());
  return {mean, std::sqrt(scatter * count / (count - 1)) / all.squares,
          0.5 * std::abs(across_rows.shift_blurs() - across_columns.shift_blurs())};
}

}  // namespace velamap
