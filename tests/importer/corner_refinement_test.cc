#include "importer/corner_refinement.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "importer/edge_fit.h"
#include "importer/pattern_fit.h"
#include "tests/importer/marker_grid.h"

namespace velamap {
namespace {

using Refiner =
    std::function<std::optional<RefinedCorners>(const cv::Mat&, const QuadPx&, const cv::Mat&)>;

struct Quality {
  int num_fitted = 0, num_failed = 0;
  double bias_px = 0.0;  // of the side length
  double rms_px = 0.0;   // of the corners
};

Quality Measure(const MarkerGrid& grid, const Refiner& refine) {
  Quality quality;
  double squares = 0.0;
  for (std::size_t k = 0; k < grid.truth.size(); ++k) {
    const auto refined = refine(grid.image, grid.starts[k], grid.cells[k]);
    if (!refined) {
      ++quality.num_failed;
      continue;
    }
    ++quality.num_fitted;
    quality.bias_px += MeanSide(refined->corners_px) - MeanSide(grid.truth[k]);
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      squares += (refined->corners_px[i] - grid.truth[k][i]).squaredNorm();
    }
  }
  if (quality.num_fitted > 0) {
    quality.bias_px /= quality.num_fitted;
    quality.rms_px = std::sqrt(squares / (kNumCorners * quality.num_fitted));
  }
  return quality;
}

Quality MeasureRefineCorners(const MarkerGrid& grid) {
  return Measure(grid, [](const cv::Mat& gray, const QuadPx& start, const cv::Mat& cells) {
    return RefineCorners(gray, start, cells);
  });
}

Quality MeasureSubpix(const MarkerGrid& grid) {
  return Measure(grid, [](const cv::Mat& gray, const QuadPx& start, const cv::Mat& cells) {
    const int half_window =
        std::clamp(static_cast<int>(std::lround(0.4 * MeanSide(start) / cells.rows)), 1, 5);
    std::vector<cv::Point2f> points;
    for (const auto& x : start) {
      points.emplace_back(static_cast<float>(x.x()), static_cast<float>(x.y()));
    }
    cv::cornerSubPix(gray, points, {half_window, half_window}, {-1, -1},
                     cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 0.01));
    RefinedCorners refined;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      refined.corners_px[i] = {points[i].x, points[i].y};
    }
    return std::make_optional(refined);
  });
}

// A chequered board: one cell of quiet zone, then black.
MarkerGridOptions Chequered(double side_px, double blur_px) {
  MarkerGridOptions options;
  options.side_px = side_px;
  options.rendering.surround_cells = 1.5;
  options.rendering.blur_sigma_px = blur_px;
  options.rendering.noise_sigma = 2.0;
  return options;
}

TEST(RefineCorners, SidesAreUnbiasedAndCornersBetterThanSubpix) {
  for (const double blur_px : {0.4, 0.7, 1.0}) {
    for (const double side_px : {12.0, 16.0, 25.0, 40.0, 65.0, 120.0}) {
      SCOPED_TRACE(testing::Message() << side_px << " px, blur " << blur_px);
      MarkerGridOptions options = Chequered(side_px, blur_px);
      options.dictionary = "DICT_4X4_50";
      const MarkerGrid grid = MakeMarkerGrid(options);
      const Quality fitted = MeasureRefineCorners(grid);
      const Quality subpix = MeasureSubpix(grid);
      EXPECT_LE(fitted.num_failed, fitted.num_fitted / 50);
      EXPECT_LT(std::abs(fitted.bias_px), side_px >= 25 ? 0.02 : 0.05);
      EXPECT_LT(fitted.rms_px, 0.25 * subpix.rms_px);
      EXPECT_LT(fitted.rms_px, side_px >= 16 ? 0.08 : 0.15);
    }
  }
}

TEST(RefineCorners, ManyCellsWideQuietZoneContrastAndLight) {
  for (const double side_px : {20.0, 60.0}) {
    for (const char* dictionary : {"DICT_4X4_50", "DICT_6X6_50"}) {
      for (const double contrast : {40.0, 220.0}) {
        SCOPED_TRACE(testing::Message() << side_px << " px, " << dictionary << ", " << contrast);
        MarkerGridOptions options = Chequered(side_px, 0.8);
        options.dictionary = dictionary;
        options.rendering.quiet_zone_cells = 2.0;
        options.rendering.surround_cells = 0.0;
        options.rendering.black = 20;
        options.rendering.white = 20 + contrast;
        options.rendering.light_gradient = 0.1;
        const MarkerGrid grid = MakeMarkerGrid(options);
        const Quality fitted = MeasureRefineCorners(grid);
        EXPECT_LE(fitted.num_failed, fitted.num_fitted / 30);
        EXPECT_LT(std::abs(fitted.bias_px), 0.04);
        EXPECT_LT(fitted.rms_px, contrast > 100 ? 0.08 : 0.25);
      }
    }
  }
}

TEST(RefineCornersByEdges, SidesBentByTheLensMeetInTheirCorners) {
  MarkerGridOptions options = Chequered(110, 0.7);
  options.camera = {CameraModel::kOpenCV, 960, 720, {600, 600, 480, 360, -0.15, 0.02, 0, 0}};
  options.max_tilt_deg = 30;
  const MarkerGrid grid = MakeMarkerGrid(options);
  const Quality fitted =
      Measure(grid, [](const cv::Mat& gray, const QuadPx& start, const cv::Mat& cells) {
        return RefineCornersByEdges(gray, start, cells.rows);
      });
  EXPECT_EQ(fitted.num_failed, 0);
  EXPECT_LT(std::abs(fitted.bias_px), 0.03);
  EXPECT_LT(fitted.rms_px, 0.08);
}

TEST(RefineCorners, FailsWhereThereIsNothingToFit) {
  const MarkerGrid small = MakeMarkerGrid(Chequered(20, 0.7));
  const MarkerGrid large = MakeMarkerGrid(Chequered(60, 0.7));
  for (const MarkerGrid* grid : {&small, &large}) {
    const QuadPx& start = grid->truth[0];
    const cv::Mat& cells = grid->cells[0];
    ASSERT_TRUE(RefineCorners(grid->image, start, cells));
    const cv::Mat flat(grid->image.size(), CV_8UC1, cv::Scalar(100));
    EXPECT_FALSE(RefineCorners(flat, start, cells));
    EXPECT_FALSE(RefineCorners(255 - grid->image, start, cells));
    QuadPx elsewhere = start, outside = start;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      elsewhere[i].x() += 0.5 * MeanSide(start);
      outside[i].x() -= start[0].x() + 100;
    }
    EXPECT_FALSE(RefineCorners(grid->image, elsewhere, cells));
    EXPECT_FALSE(RefineCorners(grid->image, outside, cells));
  }
}

TEST(EvaluateEdge, DerivativesAgreeWithDifferences) {
  EdgeParameters parameters;
  parameters.values << 0.2, -0.1, 0.15, 0.9, 40, 180, 5, -7, 0.8, 1.1;
  for (const double distance_px : {-2.1, -0.4, 0.3, 1.7}) {
    const EdgeSample sample{0.4, distance_px, 100, 0.9, 120, -110, 2.2, 2.4};
    EdgeParameters::Vector jacobian;
    EvaluateEdge(parameters, sample, &jacobian);
    for (int i = 0; i < EdgeParameters::kCount; ++i) {
      constexpr double kStep =
          0.05;  // wide, because the tabulated distribution is piecewise linear
      EdgeParameters above = parameters, below = parameters;
      above.values[i] += kStep;
      below.values[i] -= kStep;
      EdgeParameters::Vector unused;
      const double difference =
          (EvaluateEdge(above, sample, &unused) - EvaluateEdge(below, sample, &unused)) /
          (2 * kStep);
      EXPECT_NEAR(jacobian[i], difference, 0.01 * std::max(1.0, std::abs(difference)) + 0.2)
          << "parameter " << i << " at " << distance_px;
    }
  }
}

}  // namespace
}  // namespace velamap
