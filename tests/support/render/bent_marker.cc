#include "tests/support/render/bent_marker.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "importer/geometry/unit_square_map.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr int kCells = 6, kSide_px = 220;
constexpr double kFocalLength_px = 1000;
const Eigen::Vector2d kMiddle_px(kSide_px / 2, kSide_px / 2);

// What a ray in the marker frame sees of the side of the cylinder that faces the camera.
double LightAlong(const BentMarker& marker, const Eigen::Vector3d& origin,
                  const Eigen::Vector3d& direction) {
  constexpr double kBlack = 40, kWhite = 200, kBackground = 120;
  const double r = marker.radius_m, z = origin.z() + r;  // above the axis
  const double a = direction.x() * direction.x() + direction.z() * direction.z();
  const double b = origin.x() * direction.x() + z * direction.z();
  const double c = origin.x() * origin.x() + z * z - r * r;
  if (b * b < a * c) return kBackground;
  const Eigen::Vector3d x = origin + (-b - std::sqrt(b * b - a * c)) / a * direction;
  const double u = r * std::atan2(x.x(), x.z() + r) / marker.length_m + 0.5;
  const double v = 0.5 - x.y() / marker.length_m;
  const int column = static_cast<int>(std::floor(u * kCells));
  const int row = static_cast<int>(std::floor(v * kCells));
  const int outside = std::max({-column, column - kCells + 1, -row, row - kCells + 1});
  if (outside > 1) return kBackground;
  return outside == 1 || marker.cells.at<std::uint8_t>(row, column) != 0 ? kWhite : kBlack;
}

}  // namespace

Eigen::Vector3d BentMarker::Place(double x_m, double y_m) const {
  return {radius_m * std::sin(x_m / radius_m), y_m, radius_m * (std::cos(x_m / radius_m) - 1)};
}

BentMarker RandomBentMarker(std::mt19937* random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  BentMarker marker;
  marker.radius_m = marker.length_m * (2.5 + 0.5 * unit(*random));
  marker.cells = cv::Mat::zeros(kCells, kCells, CV_8U);
  for (int row = 1; row < kCells - 1; ++row) {
    for (int column = 1; column < kCells - 1; ++column) {
      marker.cells.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>((*random)() % 2);
    }
  }
  const Eigen::AngleAxisd facing(180 * kRadPerDeg, Eigen::Vector3d::UnitX());
  const double direction_rad = 180 * kRadPerDeg * unit(*random);
  const Eigen::AngleAxisd tilt(
      50 * kRadPerDeg * unit(*random),
      Eigen::Vector3d(std::cos(direction_rad), std::sin(direction_rad), 0));
  const Eigen::AngleAxisd turn(90 * kRadPerDeg * unit(*random), Eigen::Vector3d::UnitZ());
  marker.cam_from_marker.rotation = facing * tilt * turn;
  marker.cam_from_marker.translation = {0, 0, marker.length_m * (10 + 2 * unit(*random))};
  return marker;
}

BentMarkerView RenderBentMarker(const BentMarker& marker, double noise, std::mt19937* random) {
  constexpr int kSamples = 3;  // along each side of a pixel
  const Rigid3 marker_from_cam = Inverse(marker.cam_from_marker);
  cv::Mat light(kSide_px, kSide_px, CV_32F);
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
  if (noise > 0) {
    std::normal_distribution<float> normal(0, static_cast<float>(noise));
    for (float& value : cv::Mat_<float>(light)) value += normal(*random);
  }
  BentMarkerView view;
  view.camera = {CameraModel::kSimplePinhole,
                 kSide_px,
                 kSide_px,
                 {kFocalLength_px, kMiddle_px.x(), kMiddle_px.y()}};
  light.convertTo(view.gray, CV_8U);
  const auto place_px = [&](const Eigen::Vector2d& uv) -> Eigen::Vector2d {
    const Eigen::Vector3d x =
        marker.Place(marker.length_m * (uv.x() - 0.5), marker.length_m * (0.5 - uv.y()));
    return ImageFromCam(view.camera, marker.cam_from_marker * x).value().array() -
           kImageFromOpenCvPx;
  };
  view.corners_px = {place_px({0, 0}), place_px({1, 0}), place_px({1, 1}), place_px({0, 1})};
  const UnitSquareMap flat_map(view.corners_px);
  view.bend = BendByDisplacements([&](const Eigen::Vector2d& uv) -> Eigen::Vector2d {
    return place_px(uv) - flat_map.ToImage(uv.x(), uv.y());
  });
  return view;
}

}  // namespace velamap
