#include "reconstruct/sizes/bent_corners.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "importer/geometry/units.h"
#include "importer/pattern/pattern_fit.h"

namespace velamap {
namespace {

constexpr int kCells = 6;
constexpr double kFocalLength_px = 1000;
const Eigen::Vector2d kMiddle_px(110, 110);
const Camera kCamera{
    CameraModel::kSimplePinhole, 220, 220, {kFocalLength_px, kMiddle_px.x(), kMiddle_px.y()}};

struct BentMarker {
  double length_m = 0.1, radius_m = 0.2;  // around an axis along y
  Rigid3 cam_from_marker;                 // its origin is the middle of the surface
  cv::Mat cells;

  Eigen::Matrix2d Curvature() const { return Eigen::Vector2d(-1 / radius_m, 0).asDiagonal(); }
  Eigen::Vector3d Place(double x_m, double y_m) const {
    return {radius_m * std::sin(x_m / radius_m), y_m, radius_m * (std::cos(x_m / radius_m) - 1)};
  }
};

cv::Mat RandomCells(std::mt19937* random) {
  cv::Mat cells = cv::Mat::zeros(kCells, kCells, CV_8U);
  for (int row = 1; row < kCells - 1; ++row) {
    for (int column = 1; column < kCells - 1; ++column) {
      cells.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>((*random)() % 2);
    }
  }
  return cells;
}

// What a ray sees of the side of the cylinder that faces the camera.
double LightAlong(const BentMarker& marker, const Eigen::Vector3d& origin,
                  const Eigen::Vector3d& direction) {
  // In the marker frame, with the axis of the cylinder at x = 0, z = -radius.
  const double r = marker.radius_m, z = origin.z() + r;
  const double a = direction.x() * direction.x() + direction.z() * direction.z();
  const double b = origin.x() * direction.x() + z * direction.z();
  const double c = origin.x() * origin.x() + z * z - r * r;
  if (b * b < a * c) return 120;
  const Eigen::Vector3d x = origin + (-b - std::sqrt(b * b - a * c)) / a * direction;
  const double u = r * std::atan2(x.x(), x.z() + r) / marker.length_m + 0.5;
  const double v = 0.5 - x.y() / marker.length_m;
  const int column = static_cast<int>(std::floor(u * kCells));
  const int row = static_cast<int>(std::floor(v * kCells));
  const int outside = std::max({-column, column - kCells + 1, -row, row - kCells + 1});
  if (outside > 1) return 120;
  return outside == 1 || marker.cells.at<std::uint8_t>(row, column) != 0 ? 200 : 40;
}

cv::Mat Render(const BentMarker& marker) {
  constexpr int kSamples = 3;  // along each side of a pixel
  const Rigid3 marker_from_cam = Inverse(marker.cam_from_marker);
  cv::Mat light(kCamera.height_px, kCamera.width_px, CV_32F);
  for (int y = 0; y < light.rows; ++y) {
    for (int x = 0; x < light.cols; ++x) {
      double sum = 0.0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        const Eigen::Vector2d x_px(x + (i % kSamples + 0.5) / kSamples,
                                   y + (i / kSamples + 0.5) / kSamples);
        const Eigen::Vector2d ray = (x_px - kMiddle_px) / kFocalLength_px;
        sum += LightAlong(marker, marker_from_cam.translation,
                          marker_from_cam.rotation * ray.homogeneous());
      }
      light.at<float>(y, x) = static_cast<float>(sum / (kSamples * kSamples));
    }
  }
  cv::GaussianBlur(light, light, {}, 0.7);
  cv::Mat gray;
  light.convertTo(gray, CV_8U);
  return gray;
}

TEST(BentCorners, ShiftsAreThoseOfTheFitOfAFlatPattern) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  double squares_before = 0.0, squares_after = 0.0, squares_of_side = 0.0,
         squares_of_side_after = 0.0;
  for (int draw = 0; draw < 12; ++draw) {
    BentMarker marker;
    marker.radius_m = 0.25 + 0.05 * unit(random);
    marker.cells = RandomCells(&random);
    const Eigen::AngleAxisd facing(std::acos(-1.0), Eigen::Vector3d::UnitX());
    const Eigen::Vector3d axis = Eigen::Vector3d(unit(random), unit(random), 0).normalized();
    marker.cam_from_marker.rotation =
        facing * Eigen::AngleAxisd(50 * kRadPerDeg * unit(random), axis) *
        Eigen::AngleAxisd(90 * kRadPerDeg * unit(random), Eigen::Vector3d::UnitZ());
    marker.cam_from_marker.translation = Eigen::Vector3d(0, 0, 1.0 + 0.2 * unit(random));
    const cv::Mat gray = Render(marker);
    const double half_m = 0.5 * marker.length_m;
    QuadCorners truth;  // OpenCV's pixel frame
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector3d x =
          marker.Place(i == 1 || i == 2 ? half_m : -half_m, i < 2 ? half_m : -half_m);
      middle += x / kNumCorners;
      truth[i] =
          ImageFromCam(kCamera, marker.cam_from_marker * x).value().array() - kImageFromOpenCvPx;
    }
    const auto fit = FitPattern(gray, truth, KnownMarker{marker.cells}, ImageFormation());
    ASSERT_TRUE(fit);
    Rigid3 cam_from_corners = marker.cam_from_marker;
    cam_from_corners.translation = marker.cam_from_marker * middle;
    const QuadCorners shifts_px =
        CornerShiftsBySurface(kCamera, cam_from_corners, marker.length_m, marker.Curvature());
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
