#include "tests/importer/refine/marker_grid.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "importer/geometry/units.h"
#include "importer/layout/dictionary.h"

namespace velamap {
namespace {

constexpr double kLength = 0.1;

PlacedMarkerInCam PlaceMarker(const MarkerGridOptions& options, int marker_id,
                              const Eigen::Vector2d& x_in_image_px, std::mt19937* random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double tilt =
      kRadPerDeg * (options.min_tilt_deg +
                    0.5 * (options.max_tilt_deg - options.min_tilt_deg) * (1 + unit(*random)));
  const double azimuth = 180 * kRadPerDeg * unit(*random);
  const double roll = 180 * kRadPerDeg * unit(*random);
  const Eigen::Vector3d ray = CamFromImage(options.camera, x_in_image_px)->homogeneous();
  const Eigen::Vector3d tilt_axis(std::cos(azimuth), std::sin(azimuth), 0);
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray) *
      Eigen::AngleAxisd(tilt, tilt_axis) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d center = MeanFocalLength(options.camera) * kLength / options.side_px * ray;
  const double h = kLength / 2;
  return {
      marker_id,
      {center + rotation * Eigen::Vector3d(-h, -h, 0),
       center + rotation * Eigen::Vector3d(h, -h, 0), center + rotation * Eigen::Vector3d(h, h, 0),
       center + rotation * Eigen::Vector3d(-h, h, 0)}};
}

}  // namespace

MarkerGridOptions Chequered(double side_px, double blur_px) {
  MarkerGridOptions options;
  options.side_px = side_px;
  options.rendering.surround_cells = 1.5;
  options.rendering.blur_sigma_px = blur_px;
  options.rendering.noise_sigma = 2.0;
  return options;
}

MarkerGrid MakeMarkerGrid(const MarkerGridOptions& options) {
  constexpr int kNumIds = 50;
  std::mt19937 random(options.rendering.seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Dictionary dictionary = LoadDictionary(options.dictionary);
  const double pitch = 2.7 * options.side_px + 8;
  std::vector<PlacedMarkerInCam> markers;
  for (double y = 0.6 * pitch; y < options.camera.height_px - 0.6 * pitch; y += pitch) {
    for (double x = 0.6 * pitch; x < options.camera.width_px - 0.6 * pitch; x += pitch) {
      markers.push_back(PlaceMarker(options, static_cast<int>(markers.size()) % kNumIds,
                                    {x + unit(random), y + unit(random)}, &random));
    }
  }
  MarkerGrid grid;
  grid.image = RenderMarkers(options.camera, markers, dictionary, 1, options.rendering);
  for (const PlacedMarkerInCam& marker : markers) {
    grid.cells.push_back(MarkerCells(dictionary, marker.marker_id, 1));
    QuadCorners truth, start;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      truth[i] =
          *ImageFromCam(options.camera, marker.corners_in_cam[i]) - Eigen::Vector2d::Constant(0.5);
      start[i] = truth[i] + options.start_error_px * Eigen::Vector2d(unit(random), unit(random));
    }
    grid.truth.push_back(truth);
    grid.starts.push_back(start);
  }
  return grid;
}

QuadCorners SubpixCorners(const cv::Mat& gray, const QuadCorners& start, int num_cells) {
  const int half_window =
      std::clamp(static_cast<int>(std::lround(0.4 * QuadMeanSide(start) / num_cells)), 1, 5);
  std::vector<cv::Point2f> points;
  for (const auto& x : start) {
    points.emplace_back(static_cast<float>(x.x()), static_cast<float>(x.y()));
  }
  cv::cornerSubPix(gray, points, {half_window, half_window}, {-1, -1},
                   cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 0.01));
  QuadCorners refined;
  for (std::size_t i = 0; i < kNumCorners; ++i) refined[i] = {points[i].x, points[i].y};
  return refined;
}

}  // namespace velamap
