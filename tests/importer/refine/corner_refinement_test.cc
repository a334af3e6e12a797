#include "importer/refine/corner_refinement.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "importer/geometry/unit_square_map.h"
#include "importer/pattern/pattern_fit.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

using Refiner = std::function<std::optional<RefinedCorners>(const cv::Mat&, const QuadCorners&,
                                                            const cv::Mat&)>;

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
    quality.bias_px += QuadMeanSide(refined->corners_px) - QuadMeanSide(grid.truth[k]);
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
  return Measure(grid, [](const cv::Mat& gray, const QuadCorners& start, const cv::Mat& cells) {
    return RefineCorners(gray, start, {cells});
  });
}

Quality MeasureSubpix(const MarkerGrid& grid) {
  return Measure(grid, [](const cv::Mat& gray, const QuadCorners& start, const cv::Mat& cells) {
    RefinedCorners refined;
    refined.corners_px = SubpixCorners(gray, start, cells.rows);
    return std::make_optional(refined);
  });
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

// Of cells of 2 px with a narrow quiet zone before dark cloth, the search finds an outline that
// lies this far inside.
TEST(RefineCorners, OutlinesFoundFarInsideSmallMarkersGrow) {
  for (const double quiet_zone_cells : {0.4, 0.6}) {
    for (const double found_scale : {0.88, 0.82}) {
      SCOPED_TRACE(testing::Message() << quiet_zone_cells << " cells, " << found_scale);
      MarkerGridOptions options;
      options.dictionary = "DICT_4X4_50";
      options.side_px = 14;
      options.max_tilt_deg = 35;
      options.rendering.blur_sigma_px = 0.9;
      options.rendering.quiet_zone_cells = quiet_zone_cells;
      options.rendering.background = 50;
      options.rendering.noise_sigma = 1.0;
      MarkerGrid grid = MakeMarkerGrid(options);
      for (std::size_t k = 0; k < grid.truth.size(); ++k) {
        const Eigen::Vector2d center_px = UnitSquareMap(grid.truth[k]).ToImage(0.5, 0.5);
        for (std::size_t i = 0; i < kNumCorners; ++i) {
          grid.starts[k][i] =
              (center_px + found_scale * (grid.truth[k][i] - center_px)).array().round();
        }
      }
      ImageFormationParameters parameters;
      parameters.quiet_zone_cells = quiet_zone_cells;
      parameters.quiet_zone_sigma_cells = 0.1;
      const ImageFormation formation(parameters);
      const Quality fitted =
          Measure(grid, [&](const cv::Mat& gray, const QuadCorners& start, const cv::Mat& cells) {
            return RefineCorners(gray, start, {cells}, formation);
          });
      EXPECT_LE(fitted.num_failed, fitted.num_fitted / 50);
      EXPECT_LT(std::abs(fitted.bias_px), 0.05);
      EXPECT_LT(fitted.rms_px, 0.15);
    }
  }
}

// Cloth that is brighter than the paper is taken for the quiet zone at first.
TEST(RefineCorners, BrightClothBehindNarrowQuietZonesMovesNoCorner) {
  for (const double quiet_zone_cells : {0.3, 0.4, 0.5}) {
    for (const double cloth_by_paper : {1.15, 1.3}) {
      SCOPED_TRACE(testing::Message() << quiet_zone_cells << " cells, " << cloth_by_paper);
      MarkerGridOptions options;
      options.dictionary = "DICT_4X4_50";
      options.side_px = 42;
      options.rendering.white = 170;
      options.rendering.background = cloth_by_paper * options.rendering.white;
      options.rendering.quiet_zone_cells = quiet_zone_cells;
      options.rendering.blur_sigma_px = 0.6;
      options.rendering.noise_sigma = 1.0;
      ImageFormationParameters parameters;
      parameters.quiet_zone_cells = quiet_zone_cells;
      parameters.quiet_zone_sigma_cells = 0.1;
      const ImageFormation formation(parameters);
      const Quality fitted =
          Measure(MakeMarkerGrid(options),
                  [&](const cv::Mat& gray, const QuadCorners& start, const cv::Mat& cells) {
                    return RefineCorners(gray, start, {cells}, formation);
                  });
      EXPECT_EQ(fitted.num_failed, 0);
      EXPECT_LT(std::abs(fitted.bias_px), 0.004);
      EXPECT_LT(fitted.rms_px, 0.02);
    }
  }
}

// From the left to the right side of the truth, at these heights (0 top, 1 bottom).
void DrawRope(const QuadCorners& truth, double left, double right, double gray, cv::Mat* image) {
  constexpr double kBeyond = 0.4;  // sides
  constexpr int kShift = 4;        // bits behind the point of cv::line's coordinates
  const UnitSquareMap map(truth);
  const auto to_fixed = [&](double u, double v) {
    const Eigen::Vector2d x = map.ToImage(u, v) * (1 << kShift);
    return cv::Point(static_cast<int>(std::lround(x.x())), static_cast<int>(std::lround(x.y())));
  };
  cv::line(*image, to_fixed(-kBeyond, left), to_fixed(1 + kBeyond, right), cv::Scalar(gray), 2,
           cv::LINE_AA, kShift);
}

// Across the cells, and past a corner through the quiet zone.
TEST(RefineCorners, RopesMoveNoCorner) {
  struct Rope {
    double left, right;
  };
  for (const Rope rope : {Rope{0.2, 0.5}, Rope{0.9, 0.4}, Rope{0.25, -1.55}, Rope{0.75, 2.55}}) {
    SCOPED_TRACE(testing::Message() << "rope from " << rope.left);
    MarkerGridOptions options;
    options.dictionary = "DICT_4X4_50";
    options.side_px = 45;
    options.max_tilt_deg = 40;
    options.rendering.noise_sigma = 2.0;
    MarkerGrid grid = MakeMarkerGrid(options);
    for (const QuadCorners& truth : grid.truth) {
      DrawRope(truth, rope.left, rope.right, 70, &grid.image);
    }
    const Quality fitted = MeasureRefineCorners(grid);
    EXPECT_LE(fitted.num_failed, fitted.num_fitted / 20);
    EXPECT_LT(fitted.rms_px, 0.04);
  }
}

// A camera that encodes light, as most do.
ImageFormationParameters EncodingCamera() {
  ImageFormationParameters camera;
  camera.gamma = 2.2;
  camera.s_amplitude = 0.03;
  return camera;
}

// Cuts the picture 3 px beyond two sides of each marker, so that most of its quiet zone is missing.
TEST(RefineCorners, MarkersAtTheBorderOfThePictureAreAsGoodAsOthers) {
  MarkerGridOptions options;
  options.dictionary = "DICT_4X4_50";
  options.side_px = 45;
  options.max_tilt_deg = 40;
  options.rendering.noise_sigma = 1.0;
  options.rendering.camera = EncodingCamera();
  const MarkerGrid grid = MakeMarkerGrid(options);
  const ImageFormation formation(options.rendering.camera);
  const Quality fitted = Measure(grid,
                                 [&](const cv::Mat& gray, const QuadCorners& start,
                                     const cv::Mat& cells) -> std::optional<RefinedCorners> {
                                   constexpr double kReachPx = 3.0;
                                   const Box box = BoundingBox(start);
                                   const cv::Point low(static_cast<int>(box.min.x() - kReachPx),
                                                       static_cast<int>(box.min.y() - kReachPx));
                                   const cv::Mat cut =
                                       gray(cv::Rect(low, cv::Point(gray.cols, gray.rows)));
                                   const Eigen::Vector2d shift_px(low.x, low.y);
                                   QuadCorners cut_start = start;
                                   for (Eigen::Vector2d& corner : cut_start) corner -= shift_px;
                                   auto refined = RefineCorners(cut, cut_start, {cells}, formation);
                                   if (!refined) return std::nullopt;
                                   for (Eigen::Vector2d& corner : refined->corners_px)
                                     corner += shift_px;
                                   return refined;
                                 });
  EXPECT_EQ(fitted.num_failed, 0);
  EXPECT_LT(std::abs(fitted.bias_px), 0.02);
  EXPECT_LT(fitted.rms_px, 0.05);
}

// With the cells of another marker, only the sides can be fitted.
TEST(RefineCorners, SidesAloneAreFittedToLight) {
  MarkerGridOptions options;
  options.side_px = 45;
  options.max_tilt_deg = 40;
  options.rendering.quiet_zone_cells = 2.0;
  options.rendering.noise_sigma = 1.0;
  options.rendering.blur_sigma_px = 1.0;
  options.rendering.camera = EncodingCamera();
  MarkerGrid grid = MakeMarkerGrid(options);
  std::rotate(grid.cells.begin(), grid.cells.begin() + 1, grid.cells.end());
  const auto measure = [&](const ImageFormation& formation) {
    return Measure(grid, [&](const cv::Mat& gray, const QuadCorners& start, const cv::Mat& cells) {
      EXPECT_FALSE(FitPattern(gray, start, {cells}, formation));
      return RefineCorners(gray, start, {cells}, formation);
    });
  };
  const Quality fitted = measure(ImageFormation(options.rendering.camera));
  EXPECT_EQ(fitted.num_failed, 0);
  EXPECT_LT(std::abs(fitted.bias_px), 0.05);
  EXPECT_LT(fitted.rms_px, 0.08);
  EXPECT_LT(measure(ImageFormation()).bias_px, -0.5);
}

TEST(RefineCornersBySides, SidesBentByTheLensMeetInTheirCorners) {
  MarkerGridOptions options = Chequered(110, 0.7);
  options.camera = {CameraModel::kOpenCV, 960, 720, {600, 600, 480, 360, -0.15, 0.02, 0, 0}};
  options.max_tilt_deg = 30;
  const MarkerGrid grid = MakeMarkerGrid(options);
  const Quality fitted =
      Measure(grid, [](const cv::Mat& gray, const QuadCorners& start, const cv::Mat& cells) {
        return RefineCornersBySides(gray, start, cells.rows);
      });
  EXPECT_EQ(fitted.num_failed, 0);
  EXPECT_LT(std::abs(fitted.bias_px), 0.03);
  EXPECT_LT(fitted.rms_px, 0.08);
}

TEST(RefineCorners, FailsWhereThereIsNothingToFit) {
  const MarkerGrid small = MakeMarkerGrid(Chequered(20, 0.7));
  const MarkerGrid large = MakeMarkerGrid(Chequered(60, 0.7));
  for (const MarkerGrid* grid : {&small, &large}) {
    const QuadCorners& start = grid->truth[0];
    const cv::Mat& cells = grid->cells[0];
    ASSERT_TRUE(RefineCorners(grid->image, start, {cells}));
    const cv::Mat flat(grid->image.size(), CV_8UC1, cv::Scalar(100));
    EXPECT_FALSE(RefineCorners(flat, start, {cells}));
    EXPECT_FALSE(RefineCorners(255 - grid->image, start, {cells}));
    QuadCorners elsewhere = start, outside = start;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      elsewhere[i].x() += 0.5 * QuadMeanSide(start);
      outside[i].x() -= start[0].x() + 100;
    }
    EXPECT_FALSE(RefineCorners(grid->image, elsewhere, {cells}));
    EXPECT_FALSE(RefineCorners(grid->image, outside, {cells}));
  }
}

}  // namespace
}  // namespace velamap
