#include "importer/detect/marker_alignment.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "importer/detect/marker_location.h"
#include "importer/refine/corner_refinement.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

MarkerGrid MakeGrid(double side_px, double start_error_px) {
  MarkerGridOptions options;
  options.side_px = side_px;
  options.max_tilt_deg = 50;
  options.start_error_px = start_error_px;
  options.rendering.blur_sigma_px = 0.8;
  options.rendering.noise_sigma = 2.0;
  return MakeMarkerGrid(options);
}

QuadCorners Moved(const QuadCorners& quad, double x_px, double y_px) {
  QuadCorners moved = quad;
  for (Eigen::Vector2d& corner : moved) corner += Eigen::Vector2d(x_px, y_px);
  return moved;
}

TEST(AlignSides, CornersAreWithinAFractionOfAPixel) {
  for (const double side_px : {22.0, 40.0, 90.0}) {
    const MarkerGrid grid = MakeGrid(side_px, 0.7);
    std::size_t num_aligned = 0;
    for (std::size_t k = 0; k < grid.truth.size(); ++k) {
      const auto aligned = AlignSides(grid.image, grid.starts[k], {grid.cells[k]});
      if (!aligned) continue;
      ++num_aligned;
      EXPECT_LT(MaxCornerShift(*aligned, grid.truth[k]), 0.6) << side_px << " px, marker " << k;
    }
    EXPECT_GE(num_aligned, 0.95 * static_cast<double>(grid.truth.size())) << side_px << " px";
  }
}

TEST(LocateMarker, FindsAMarkerAFewCellsAway) {
  for (const double side_px : {22.0, 40.0, 90.0}) {
    const MarkerGrid grid = MakeGrid(side_px, 0.0);
    for (std::size_t k = 0; k < grid.truth.size(); ++k) {
      const double away_px = 0.4 * QuadMeanSide(grid.truth[k]);
      const QuadCorners expected = Moved(grid.truth[k], away_px, -0.7 * away_px);
      const auto located = LocateMarker(grid.image, expected, {grid.cells[k]}, away_px);
      ASSERT_TRUE(located) << side_px << " px, marker " << k;
      EXPECT_LT(MaxCornerShift(*located, grid.truth[k]), 0.6) << side_px << " px, marker " << k;
    }
  }
}

TEST(LocateMarker, AnInvertedMarkerIsFoundAsSuchOnly) {
  MarkerGrid grid = MakeGrid(40, 0.0);
  grid.image = 255 - grid.image;
  EXPECT_TRUE(LocateMarker(grid.image, grid.truth[0], {grid.cells[0], true}, 5));
  EXPECT_FALSE(LocateMarker(grid.image, grid.truth[0], {grid.cells[0], false}, 5));
}

TEST(LocateMarker, TakesNoOtherMarkerNoTurnedOneAndNoneOutside) {
  const MarkerGrid grid = MakeGrid(40, 0.0);
  for (std::size_t k = 1; k < grid.truth.size(); ++k) {
    EXPECT_FALSE(LocateMarker(grid.image, grid.truth[k], {grid.cells[0]}, 8)) << k;
    QuadCorners turned = grid.truth[k];
    std::rotate(turned.begin(), turned.begin() + 1, turned.end());
    EXPECT_FALSE(LocateMarker(grid.image, turned, {grid.cells[k]}, 8)) << k;
  }
  EXPECT_FALSE(LocateMarker(grid.image, Moved(grid.truth[0], 1e4, 0), {grid.cells[0]}, 8));
}

TEST(LocateMarker, AQuadWithoutAreaOrPlaceIsNone) {
  const MarkerGrid grid = MakeGrid(40, 0.0);
  QuadCorners point;
  point.fill(grid.truth[0][0]);
  QuadCorners nowhere = grid.truth[0];
  nowhere[2].x() = std::nan("");
  for (const QuadCorners& quad : {point, nowhere}) {
    EXPECT_FALSE(LocateMarker(grid.image, quad, {grid.cells[0]}, 8));
    EXPECT_FALSE(AlignSides(grid.image, quad, {grid.cells[0]}));
    EXPECT_FALSE(RefineCorners(grid.image, quad, {grid.cells[0]}));
  }
}

// A marker with a cell of the other colour is another one, or half hidden.
TEST(LocateMarker, EveryCellCounts) {
  MarkerGrid grid = MakeGrid(60, 0.0);
  cv::Mat& cells = grid.cells[0];
  EXPECT_TRUE(LocateMarker(grid.image, grid.truth[0], {cells}, 3));
  cells.at<std::uint8_t>(3, 3) = static_cast<std::uint8_t>(255 - cells.at<std::uint8_t>(3, 3));
  EXPECT_FALSE(LocateMarker(grid.image, grid.truth[0], {cells}, 3));
}

// What becomes of the corners where refinement starts from `starts` instead of the truth.
struct StartDependence {
  std::size_t num_compared = 0, num_same = 0;  // markers
  double mean_square = 0.0;                    // of the corners' distances, in their sigmas
};

StartDependence CompareStarts(const MarkerGrid& grid) {
  constexpr double kSame_px = 0.01;
  StartDependence result;
  for (std::size_t k = 0; k < grid.truth.size(); ++k) {
    const auto from_truth = RefineCorners(grid.image, grid.truth[k], {grid.cells[k]});
    const auto from_start = RefineCorners(grid.image, grid.starts[k], {grid.cells[k]});
    if (!from_truth || !from_start) continue;
    ++result.num_compared;
    result.num_same += MaxCornerShift(from_truth->corners_px, from_start->corners_px) < kSame_px;
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      result.mean_square += (from_truth->corners_px[c] - from_start->corners_px[c]).squaredNorm() /
                            (2 * std::pow(from_truth->sigma_px[c], 2));
    }
  }
  result.mean_square /= static_cast<double>(kNumCorners * result.num_compared);
  return result;
}

TEST(RefineCorners, DoNotDependOnWhereTheQuadCameFrom) {
  for (const double side_px : {22.0, 25.0}) {
    const MarkerGrid grid = MakeGrid(side_px, 0.5);
    const StartDependence found = CompareStarts(grid);
    EXPECT_GE(found.num_compared, 0.95 * static_cast<double>(grid.truth.size())) << side_px;
    EXPECT_GE(found.num_same, 0.95 * static_cast<double>(found.num_compared)) << side_px;
  }
}

// Only a part of the pixels of a large marker is fitted, and the start chooses which.
TEST(RefineCorners, OfLargeMarkersDifferLessThanThoseOfIndependentPixels) {
  constexpr double kOfIndependentPixels = 2.0;  // the variance of a difference
  const MarkerGrid grid = MakeGrid(60.0, 0.5);
  const StartDependence found = CompareStarts(grid);
  EXPECT_EQ(found.num_compared, grid.truth.size());
  EXPECT_LT(found.mean_square, kOfIndependentPixels);
}

}  // namespace
}  // namespace velamap
