#include "importer/bend/pattern_bend.h"

#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/unit_square_map.h"
#include "importer/pattern/pattern_fit.h"
#include "tests/importer/refine/marker_grid.h"

namespace velamap {
namespace {

const Camera kFisheye{
    CameraModel::kOpenCVFisheye, 1400, 1000, {480, 480, 700, 500, 0.02, -0.01, 0, 0}};
const Camera kBarrel{
    CameraModel::kOpenCV, 1400, 1000, {900, 900, 690, 510, -0.28, 0.08, 1e-3, -1e-3}};

TEST(BendByLens, ALensWithoutDistortionBendsNothing) {
  const Camera pinhole{CameraModel::kPinhole, 1400, 1000, {900, 910, 700, 500}};
  const PatternBend bend = BendByLens(pinhole, {{{100, 100}, {220, 110}, {210, 240}, {95, 230}}});
  EXPECT_TRUE(bend.coefficients_px.isZero(0));
}

// Places of random flat markers are where the camera projects them.
TEST(BendByLens, IsTheDistortionWithinTheCorners) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Camera& camera : {kFisheye, kBarrel}) {
    for (int draw = 0; draw < 50; ++draw) {
      const Eigen::Vector3d middle(1.6 * unit(random) - 0.8, 1.2 * unit(random) - 0.6, 1);
      const Eigen::Vector3d along(0.14, 0.03 * unit(random), 0.05 * unit(random));
      const Eigen::Vector3d down(0.03 * unit(random), 0.14, -0.05 * unit(random));
      const auto project = [&](double u, double v) {
        const auto x_px = ImageFromCam(camera, middle + (u - 0.5) * along + (v - 0.5) * down);
        const Eigen::Vector2d none(1e6, 1e6);
        return Eigen::Vector2d(x_px.value_or(none).array() - kImageFromOpenCvPx);
      };
      const QuadCorners corners_px = {project(0, 0), project(1, 0), project(1, 1), project(0, 1)};
      const PatternBend bend = BendByLens(camera, corners_px);
      const UnitSquareMap flat(corners_px);
      for (int i = 0; i < 20; ++i) {
        const double u = unit(random), v = unit(random);
        const Eigen::Vector2d expected_px = project(u, v);
        const double flat_error_px = (flat.ToImage(u, v) - expected_px).norm();
        EXPECT_LT((flat.ToImage(u, v) + bend.At(u, v) - expected_px).norm(),
                  0.002 + 0.05 * flat_error_px);
      }
    }
  }
}

// What no fit knew: large markers through a wide lens came out too large.
TEST(FitPattern, ALensThatBendsMarkersMovesNoSide) {
  for (const Camera& camera : {kFisheye, kBarrel}) {
    MarkerGridOptions options;
    options.dictionary = "DICT_4X4_50";
    options.side_px = 90;
    options.camera = camera;
    options.rendering.noise_sigma = 1.0;
    const MarkerGrid grid = MakeMarkerGrid(options);
    double with_px = 0.0, without_px = 0.0, corrected_px = 0.0;
    double squares_without = 0.0, squares_corrected = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < grid.truth.size(); ++k) {
      KnownMarker marker{grid.cells[k]};
      const auto without = FitPattern(grid.image, grid.starts[k], marker, ImageFormation());
      marker.lens_bend = BendByLens(camera, grid.starts[k]);
      const auto with = FitPattern(grid.image, grid.starts[k], marker, ImageFormation());
      if (!with || !without) continue;
      const double truth_px = QuadMeanSide(grid.truth[k]);
      with_px += QuadMeanSide(with->corners_px) - truth_px;
      without_px += QuadMeanSide(without->corners_px) - truth_px;
      QuadCorners corrected = without->corners_px;
      const QuadCorners shifts_px = CornerShiftsByBend(BendByLens(camera, corrected), corrected);
      for (std::size_t i = 0; i < kNumCorners; ++i) corrected[i] -= shifts_px[i];
      corrected_px += QuadMeanSide(corrected) - truth_px;
      for (std::size_t i = 0; i < kNumCorners; ++i) {
        squares_without += (without->corners_px[i] - grid.truth[k][i]).squaredNorm();
        squares_corrected += (corrected[i] - grid.truth[k][i]).squaredNorm();
      }
      ++count;
    }
    ASSERT_GT(count, 10);
    EXPECT_LT(std::abs(with_px / count), 0.01);
    EXPECT_GT(without_px / count, 0.02);
    EXPECT_LT(std::abs(corrected_px / count), 0.005);
    EXPECT_LT(squares_corrected, 0.3 * squares_without);
    RecordProperty("bias_px", std::to_string(with_px / count) + " " +
                                  std::to_string(without_px / count) + " " +
                                  std::to_string(corrected_px / count));
  }
}

}  // namespace
}  // namespace velamap
