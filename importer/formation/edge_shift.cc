#include "importer/formation/edge_shift.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "importer/pattern/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

// Least-squares fit of a shift to the residuals at inner edges.
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
  double shift() const { return squares > 0 ? by_residual / squares : 0.0; }
};

// Sums over the edges that the rows of the image cross, and over those that its columns cross; and
// sums for the distance of the marker's corners from its centre, over all edges and over those far
// from the corners of outlines. Some filters round these corners farther than the pixels that are
// left out elsewhere.
struct SampleShift {
  ShiftSums across_rows, across_columns, outwards, outwards_far_from_corners;
};

// The derivative of grey values with respect to the distance of all corners from the centre, along
// both sides.
double ByCornersOutwards(const PatternPixels& pixels, const QuadCorners& corners_px) {
  const Eigen::Vector2d center = QuadCenter(corners_px);
  const double half_side = 0.5 * QuadMeanSide(corners_px);
  double derivative = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector2d by_corner(pixels.jacobian[P::kCorners + 2 * i][0],
                                    pixels.jacobian[P::kCorners + 2 * i + 1][0]);
    derivative += by_corner.dot(corners_px[i] - center) / half_side;
  }
  return derivative;
}

SampleShift ShiftOf(const FittedSample& sample, double noise) {
  constexpr double kStepBlurs = 0.04;
  constexpr float kWideReachPx = 4.0f, kWideReachCells = 0.5f;
  const PatternProblem& problem = sample.problem;
  PatternModel shifted = problem.model;
  shifted.edge_shift_blurs += kStepBlurs;
  const PatternPicture picture(problem.model, sample.minimum.parameters);
  const PatternPicture moved_picture(shifted, sample.minimum.parameters);
  const cv::Point patch_from_box = problem.box.tl() - problem.patch.origin_px;
  const QuadCorners corners_px = CornersOf(sample.minimum.parameters);
  const double weight = 1 / (noise * noise);
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
    shift.across_rows.Add(by_shift, residual, weight * by_x * by_x / squared_slope);
    shift.across_columns.Add(by_shift, residual, weight * by_y * by_y / squared_slope);
    const double by_outwards = ByCornersOutwards(pixels, corners_px);
    shift.outwards.Add(by_outwards, residual, weight);
    if (!picture.IsAtOutlineCorner(x, y, kWideReachPx, kWideReachCells)[0]) {
      shift.outwards_far_from_corners.Add(by_outwards, residual, weight);
    }
  }
  return shift;
}

ShiftSums Total(const std::vector<ShiftSums>& samples) {
  ShiftSums total;
  for (const ShiftSums& sample : samples) total += sample;
  return total;
}

// 1 sigma of the shift of all samples together.
double SigmaByScatter(const std::vector<ShiftSums>& samples) {
  const ShiftSums total = Total(samples);
  double scatter = 0.0;
  for (const ShiftSums& sample : samples) {
    const double deviation = sample.by_residual - sample.squares * total.shift();
    scatter += deviation * deviation;
  }
  const auto count = static_cast<double>(samples.size());
  return std::sqrt(scatter * count / (count - 1)) / total.squares;
}

}  // namespace

EdgeShift InnerEdgeShift(const FormationState& state) {
  const std::vector<double> noises = NoisesOf(state);
  std::vector<ShiftSums> across_rows, across_columns, across_all, outwards, far;
  for (std::size_t i = 0; i < state.samples.size(); ++i) {
    if (state.samples[i].residuals.empty()) continue;
    const SampleShift shift = ShiftOf(state.samples[i], noises[i]);
    across_rows.push_back(shift.across_rows);
    across_columns.push_back(shift.across_columns);
    across_all.push_back(shift.across_rows);
    across_all.back() += shift.across_columns;
    outwards.push_back(shift.outwards);
    far.push_back(shift.outwards_far_from_corners);
  }
  if (across_all.size() < 2 || !(Total(across_all).squares > 0)) return {};
  EdgeShift shift;
  shift.mean_blurs = Total(across_all).shift();
  shift.sigma_blurs = SigmaByScatter(across_all);
  shift.half_difference_blurs =
      0.5 * std::abs(Total(across_rows).shift() - Total(across_columns).shift());
  const double near_px = Total(outwards).shift(), far_px = Total(far).shift();
  shift.corners_outwards_px = 0.5 * (near_px + far_px);
  shift.corners_sigma_px = std::hypot(SigmaByScatter(outwards), 0.5 * (near_px - far_px));
  return shift;
}

}  // namespace velamap
