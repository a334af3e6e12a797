#include "reconstruct/sizes/bent_corners.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/pattern/pattern_fit.h"
#include "tests/support/render/bent_marker.h"

namespace velamap {
namespace {

TEST(BentCorners, ShiftsAreThoseOfTheFitOfAFlatPattern) {
  std::mt19937 random(5);
  double squares_before = 0.0, squares_after = 0.0;
  double squares_of_side = 0.0, squares_of_side_after = 0.0;
  for (int draw = 0; draw < 12; ++draw) {
    const BentMarker marker = RandomBentMarker(&random);
    const BentMarkerView view = RenderBentMarker(marker, 0.0, &random);
    const QuadCorners& truth = view.corners_px;
    const auto fit = FitPattern(view.gray, truth, KnownMarker{marker.cells}, ImageFormation());
    ASSERT_TRUE(fit);
    const double half_m = 0.5 * marker.length_m;
    Rigid3 cam_from_corners = marker.cam_from_marker;
    cam_from_corners.translation =
        marker.cam_from_marker * Eigen::Vector3d(0, 0, marker.Place(half_m, half_m).z());
    const Eigen::Matrix2d curvature_1_m = Eigen::Vector2d(-1 / marker.radius_m, 0).asDiagonal();
    const QuadCorners shifts_px =
        CornerShiftsBySurface(view.camera, cam_from_corners, marker.length_m, curvature_1_m);
    QuadCorners corrected_px = fit->corners_px;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      corrected_px[i] -= shifts_px[i];
      squares_before += (fit->corners_px[i] - truth[i]).squaredNorm();
      squares_after += (corrected_px[i] - truth[i]).squaredNorm();
    }
    const double truth_px = QuadMeanSide(truth);
    squares_of_side += std::pow(QuadMeanSide(fit->corners_px) - truth_px, 2);
    squares_of_side_after += std::pow(QuadMeanSide(corrected_px) - truth_px, 2);
  }
  EXPECT_LT(squares_after, 0.2 * squares_before);
  EXPECT_LT(squares_of_side_after, 0.03 * squares_of_side);
  RecordProperty("squares_px2",
                 std::to_string(squares_before) + " " + std::to_string(squares_after) + " " +
                     std::to_string(squares_of_side) + " " + std::to_string(squares_of_side_after));
}

}  // namespace
}  // namespace velamap
