#include "tests/support/study/corner_study.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>

#include "importer/geometry/units.h"
#include "importer/pattern/pattern_picture.h"
#include "importer/refine/corner_refinement.h"
#include "tests/support/clip/clip_scene_builder.h"
#include "tests/support/study/photographed_grid.h"

namespace velamap {
namespace {

constexpr int kMaxWidthPx = 2400;

cv::Mat Compressed(const cv::Mat& image, int jpeg_quality) {
  if (jpeg_quality == 0) return image;
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
}

// As many markers as a picture of limited size holds.
Camera MakeCamera(double side_px) {
  const double pitch_px = 2.7 * side_px + 8;
  const int width_px = std::min(kMaxWidthPx, static_cast<int>(std::ceil(12.5 * pitch_px)));
  const int height_px = width_px * 3 / 4;
  const double focal_px = 1.4 * width_px;
  return {CameraModel::kPinhole,
          width_px,
          height_px,
          {focal_px, focal_px, 0.5 * width_px, 0.5 * height_px}};
}

MarkerGrid MakeFlatGrid(const CornerCase& parameters, std::uint32_t seed) {
  MarkerGridOptions options;
  options.dictionary = "DICT_4X4_50";
  options.side_px = parameters.side_px;
  options.min_tilt_deg = parameters.min_tilt_deg;
  options.max_tilt_deg = parameters.max_tilt_deg;
  options.camera = MakeCamera(parameters.side_px);
  options.rendering.blur_sigma_px = parameters.blur_px;
  options.rendering.noise_sigma = parameters.noise;
  options.rendering.seed = seed;
  return MakeMarkerGrid(options);
}

// A cylinder with an upright axis, its face to the camera, and markers on it. The picture's middle
// sees a marker of the wanted size head-on; the others are smaller and tilted.
ClipScene MakeBentScene(const CornerCase& parameters, std::uint32_t seed) {
  constexpr double kMarker_m = 0.1, kHalfArc_rad = 0.9;
  const double radius_m = kMarker_m / (parameters.bend_deg * kRadPerDeg);
  const double height_m = 1.2 * radius_m;
  const Surface cylinder = [=](const Eigen::Vector2d& uv) {
    const double angle = kHalfArc_rad * (2 * uv.x() - 1);
    return Eigen::Vector3d(radius_m * std::sin(angle), -radius_m * std::cos(angle),
                           height_m * (uv.y() - 0.5));
  };
  ClipOptions options;
  options.wide_angle = false;
  options.seed = seed;
  options.num_frames = 1;
  ClipSceneBuilder builder(options, kMarker_m);
  const Ground ground{cylinder, cylinder};
  builder.AddSheet(ground, 64, 1);
  const int num_columns = static_cast<int>(2 * kHalfArc_rad * radius_m / (2 * kMarker_m));
  const int num_rows = static_cast<int>(height_m / (2 * kMarker_m));
  for (int i = 0; i < num_columns * num_rows; ++i) {
    builder.AddMarker(ground, "",
                      {(i % num_columns + 0.5) / num_columns, (i / num_columns + 0.5) / num_rows});
  }
  ClipScene scene = builder.scene();
  const double px_per_m = parameters.side_px / kMarker_m;
  const int width_px = static_cast<int>(2.2 * radius_m * px_per_m);
  const double focal_px = 4.0 * width_px, distance_m = focal_px / px_per_m + radius_m;
  scene.camera = {CameraModel::kPinhole,
                  width_px,
                  width_px * 3 / 4,
                  {focal_px, focal_px, 0.5 * width_px, 0.375 * width_px}};
  // A little to the side and rolled, so that no side runs along the pixels.
  const Eigen::Quaterniond cam_from_world =
      Eigen::AngleAxisd(0.2 + 0.3 * seed, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(90 * kRadPerDeg, Eigen::Vector3d::UnitX());
  scene.cam_from_world = [pose = Rigid3{cam_from_world, {0.001 * seed, 0, distance_m}}](double) {
    return pose;
  };
  return scene;
}

MarkerGrid MakeBentGrid(const CornerCase& parameters, std::uint32_t seed) {
  const ClipScene scene = MakeBentScene(parameters, seed);
  SurfaceRenderOptions rendering;
  rendering.blur_px = parameters.blur_px;
  rendering.noise = parameters.noise;
  return PhotographedGrid(scene, rendering);
}

// Mean variance of a coordinate by the Cramer-Rao bound.
double VarianceBound(const MarkerGrid& grid, std::size_t k, const CornerCase& parameters) {
  using P = PatternParameters;
  constexpr int kNumKnown = P::kGradientX;  // corners, blur and grey levels are unknown
  const QuadCorners& truth = grid.truth[k];
  const UnitSquareMap map(truth);
  PatternModel model;
  model.num_cells = grid.cells[k].rows;
  model.center_px = map.ToImage(0.5, 0.5);
  model.diagonal_px = std::sqrt(2.0) * QuadMeanSide(truth);
  const RenderOptions rendering;
  P::Vector p = P::Vector::Zero();
  for (int i = 0; i < kNumCorners; ++i) {
    p.segment<2>(2 * i) = truth[static_cast<std::size_t>(i)];
  }
  p[P::kBlurU] = p[P::kBlurV] = std::hypot(parameters.blur_px, std::sqrt(1.0 / 12));
  p[P::kDark] = rendering.black;
  p[P::kLight] = rendering.white;
  p[P::kSurround] = p[P::kInnerLight] = 1.0;
  p.segment<4>(P::kMargin).setOnes();
  const ImageFormation linear;
  model.formation = &linear;
  FillLightness(CutPatch(grid.image, cv::Rect({}, grid.image.size()), linear), grid.cells[k], p,
                &model);
  P::Matrix information = P::Matrix::Zero();
  const PatternPicture picture(model, p);
  PatternPixels pixels;
  for (int row = 0; row < grid.image.rows; ++row) {
    if (std::abs(row - model.center_px.y()) > 1.5 * model.diagonal_px) continue;
    for (int column = 0; column < grid.image.cols; ++column) {
      const Eigen::Vector2d x(column, row);
      if ((x - model.center_px).norm() > 1.5 * model.diagonal_px) continue;
      const Floats from_center_x = AllLanes(x.x() - model.center_px.x());
      const Floats from_center_y = AllLanes(x.y() - model.center_px.y());
      if (!picture.Covers(from_center_x, from_center_y)[0]) continue;
      picture.At(from_center_x, from_center_y, &pixels);
      P::Vector jacobian;
      for (int i = 0; i < P::kCount; ++i)
        jacobian[i] = pixels.jacobian[static_cast<std::size_t>(i)][0];
      information.noalias() += jacobian * jacobian.transpose();
    }
  }
  const Eigen::MatrixXd known = information.topLeftCorner(kNumKnown, kNumKnown);
  const Eigen::MatrixXd covariance =
      known.ldlt().solve(Eigen::MatrixXd::Identity(kNumKnown, kNumKnown));
  const double pixel_variance = parameters.noise * parameters.noise + 1.0 / 12;
  return pixel_variance * covariance.diagonal().head<2 * kNumCorners>().mean();
}

// Sums errors of corners along and across the diagonals, so that a common inset can be taken out.
class ErrorSums {
 public:
  void Add(const QuadCorners& found, const QuadCorners& truth) {
    const Eigen::Vector2d middle = QuadCenter(truth);
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector2d error = found[i] - truth[i];
      outwards_ += error.dot((truth[i] - middle).normalized());
      squares_ += error.squaredNorm();
      ++count_;
    }
    const double side_error = QuadMeanSide(found) - QuadMeanSide(truth);
    side_errors_ += side_error;
    squared_side_errors_ += side_error * side_error;
  }

  int NumMarkers() const { return count_ / kNumCorners; }
  double SideBias() const { return side_errors_ / NumMarkers(); }
  double SideBiasSigma() const {
    const double n = NumMarkers();
    return std::sqrt(std::max(0.0, squared_side_errors_ / n - SideBias() * SideBias()) / n);
  }
  double Std() const {
    const double inset = outwards_ / count_;
    return std::sqrt(0.5 * (squares_ / count_ - inset * inset));
  }

 private:
  int count_ = 0;
  double outwards_ = 0.0, squares_ = 0.0, side_errors_ = 0.0, squared_side_errors_ = 0.0;
};

}  // namespace

CornerAccuracy MeasureCorners(const CornerCase& parameters) {
  CornerAccuracy accuracy;
  ErrorSums fitted, subpix;
  double bounds = 0.0, normalized_squares = 0.0;
  for (std::uint32_t seed = parameters.seed; fitted.NumMarkers() < parameters.min_markers; ++seed) {
    MarkerGrid grid =
        parameters.bend_deg > 0 ? MakeBentGrid(parameters, seed) : MakeFlatGrid(parameters, seed);
    grid.image = Compressed(grid.image, parameters.jpeg_quality);
    for (std::size_t k = 0; k < grid.truth.size(); ++k) {
      subpix.Add(SubpixCorners(grid.image, grid.starts[k], grid.cells[k].rows), grid.truth[k]);
      const auto refined = RefineCorners(grid.image, grid.starts[k], {grid.cells[k]});
      if (!refined) {
        ++accuracy.num_failed;
        continue;
      }
      fitted.Add(refined->corners_px, grid.truth[k]);
      bounds += VarianceBound(grid, k, parameters);
      for (std::size_t i = 0; i < kNumCorners; ++i) {
        normalized_squares += (refined->corners_px[i] - grid.truth[k][i]).squaredNorm() /
                              (2 * kNumCorners * refined->sigma_px[i] * refined->sigma_px[i]);
      }
    }
    if (seed - parameters.seed > 100) break;  // hardly any marker can be fitted
  }
  accuracy.num_markers = fitted.NumMarkers();
  accuracy.side_bias_px = fitted.SideBias();
  accuracy.side_bias_sigma_px = fitted.SideBiasSigma();
  accuracy.std_px = fitted.Std();
  accuracy.subpix_side_bias_px = subpix.SideBias();
  accuracy.subpix_std_px = subpix.Std();
  accuracy.bound_px = std::sqrt(bounds / accuracy.num_markers);
  accuracy.error_over_sigma = std::sqrt(normalized_squares / accuracy.num_markers);
  return accuracy;
}

}  // namespace velamap
