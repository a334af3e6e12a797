#include "reconstruct/sizes/bent_corners.h"

#include <cmath>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"
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

// The picture of a light as a camera with this tone curve stores it.
cv::Mat Encoded(const cv::Mat& light, const ToneCurve& tone) {
  cv::Mat encoded = light.clone();
  const double white = tone.Decode(255);
  encoded.forEach<std::uint8_t>([&](std::uint8_t& level, const int*) {
    level = cv::saturate_cast<std::uint8_t>(tone.Encode(white * level / 255));
  });
  return encoded;
}

Eigen::Vector2d MeanShift_px(const QuadCorners& corners_px, const QuadCorners& truth_px) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < kNumCorners; ++i) sum += corners_px[i] - truth_px[i];
  return sum / kNumCorners;
}

// A tone curve moves an edge by a share of its blur. The bend of a tilted marker compresses the
// cells at one end, where the blur is wider in cells than at the other end. If a fit took both for
// equal, it would find the middle of the marker 0.04 px away.
TEST(BentCorners, AToneCurveDoesNotMoveTheMiddleOfATiltedMarker) {
  ImageFormationParameters camera;
  camera.gamma = 2.2;
  const ImageFormation linear, encoding(camera);
  std::mt19937 random(7);
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
  constexpr int kNumDraws = 12;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    BentMarker marker = RandomBentMarker(&random);
    marker.cam_from_marker.rotation =
        Eigen::AngleAxisd(180 * kRadPerDeg, Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(50 * kRadPerDeg, Eigen::Vector3d::UnitY());
    const BentMarkerView view = RenderBentMarker(marker, 0.0, &random);
    const KnownMarker known{marker.cells};
    const auto in_linear = FitPattern(view.gray, view.corners_px, known, linear);
    const auto in_encoded =
        FitPattern(Encoded(view.gray, encoding.tone()), view.corners_px, known, encoding);
    ASSERT_TRUE(in_linear && in_encoded);
    mean_px += MeanShift_px(in_encoded->corners_px, in_linear->corners_px) / kNumDraws;
  }
  EXPECT_LT(mean_px.norm(), 0.015);
}

}  // namespace
}  // namespace velamap
