#include "reconstruct/camera/focal_evidence.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "importer/geometry/rigid3.h"
#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

// Squares in random poses inside the picture, with noise.
std::vector<SquareView> Draw(const Camera& camera, int num_views, double max_tilt, double noise_px,
                             std::mt19937* generator) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  std::vector<SquareView> views;
  while (static_cast<int>(views.size()) < num_views) {
    const auto ray = CamFromImage(
        camera, {unit(*generator) * camera.width_px, unit(*generator) * camera.height_px});
    if (!ray) continue;
    const double distance = 6.0 + 6.0 * unit(*generator);
    const double azimuth = 6.28 * unit(*generator), roll = 6.28 * unit(*generator);
    const Eigen::AngleAxisd tilt(max_tilt * unit(*generator),
                                 Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0));
    // The face looks along -z, at the camera.
    const Rigid3 pose{
        Eigen::Quaterniond(tilt * Eigen::AngleAxisd(3.14159265, Eigen::Vector3d::UnitX()) *
                           Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ())),
        distance * ray->homogeneous().normalized()};
    SquareView view;
    view.sigma_px = std::max(noise_px, 1e-3);
    bool is_inside = true;
    for (int i = 0; i < kNumCorners; ++i) {
      const auto corner = static_cast<std::size_t>(i);
      const auto x_px = ImageFromCam(camera, pose * CornersInMarker(1.0)[corner]);
      is_inside = is_inside && x_px && x_px->x() > 0 && x_px->y() > 0 &&
                  x_px->x() < camera.width_px && x_px->y() < camera.height_px;
      if (!is_inside) break;
      view.corners_px[corner] =
          *x_px + noise_px * Eigen::Vector2d(normal(*generator), normal(*generator));
    }
    if (is_inside) views.push_back(view);
  }
  return views;
}

Camera Lens(CameraModel model, double focal_px) {
  if (model == CameraModel::kOpenCVFisheye) {
    return {model, 1920, 1080, {focal_px, focal_px, 960, 540, 0, 0, 0, 0}};
  }
  return {model, 1920, 1080, {focal_px, 960, 540, 0}};
}

TEST(FocalEvidence, ExactSquaresGiveTheFocalLength) {
  std::mt19937 generator(1);
  for (const CameraModel model : {CameraModel::kSimpleRadial, CameraModel::kOpenCVFisheye}) {
    for (const double focal_px : {700.0, 1500.0, 4000.0}) {
      const Camera camera = Lens(model, focal_px);
      const FocalEvidence evidence =
          FindFocalLength(model, 1920, 1080, Draw(camera, 40, 1.0, 0.0, &generator));
      EXPECT_NEAR(MeanFocalLength(evidence.camera) / focal_px, 1.0, 1e-4) << focal_px;
      EXPECT_EQ(evidence.num_views, 40);
    }
  }
}

TEST(FocalEvidence, NoisySquaresGiveItWithinTheSigma) {
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double sum = 0.0;
  constexpr int kNumDraws = 40;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    const double focal_px = 1920 * (0.5 + 1.1 * unit(generator));
    const Camera camera = Lens(CameraModel::kSimpleRadial, focal_px);
    const FocalEvidence evidence =
        FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080,
                        Draw(camera, 150, 1.0, 0.1 + 0.2 * unit(generator), &generator));
    const double error = std::log(MeanFocalLength(evidence.camera) / focal_px);
    EXPECT_LT(std::abs(error), 4.0 * evidence.log_sigma) << draw;
    EXPECT_LT(evidence.log_sigma, 0.1);
    sum += std::pow(error / evidence.log_sigma, 2);
  }
  // Chi-squared with 40 degrees of freedom is between these with 99.9 %.
  EXPECT_GT(sum / kNumDraws, 0.45);
  EXPECT_LT(sum / kNumDraws, 1.84);
}

TEST(FocalEvidence, FisheyeAndStraightLensAreToldApart) {
  std::mt19937 generator(3);
  for (const CameraModel truth : {CameraModel::kSimpleRadial, CameraModel::kOpenCVFisheye}) {
    const std::vector<SquareView> views = Draw(Lens(truth, 900), 200, 1.0, 0.1, &generator);
    const double straight = FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080, views).cost;
    const double fisheye = FindFocalLength(CameraModel::kOpenCVFisheye, 1920, 1080, views).cost;
    EXPECT_EQ(fisheye < straight, truth == CameraModel::kOpenCVFisheye);
  }
}

TEST(FocalEvidence, SquaresThatFaceTheCameraSayLittle) {
  std::mt19937 generator(4);
  const Camera camera = Lens(CameraModel::kSimpleRadial, 3000);
  const auto tilted = FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080,
                                      Draw(camera, 60, 1.0, 0.2, &generator));
  const auto facing = FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080,
                                      Draw(camera, 60, 0.02, 0.2, &generator));
  EXPECT_GT(facing.log_sigma, 5.0 * tilted.log_sigma);
  EXPECT_FALSE(std::isfinite(FindFocalLength(CameraModel::kSimpleRadial, 640, 480, {}).log_sigma));
}

TEST(FocalEvidence, ResultDoesNotDependOnThreads) {
  std::mt19937 generator(5);
  const auto views = Draw(Lens(CameraModel::kSimpleRadial, 1200), 50, 1.0, 0.2, &generator);
  const auto one = FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080, views, 1);
  const auto two = FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080, views, 2);
  EXPECT_EQ(one.camera, two.camera);
  EXPECT_EQ(one.log_sigma, two.log_sigma);
}

// With few squares, small errors may be chance.
TEST(FocalEvidence, AFewSquaresAreNoBetterThanTheirSigmas) {
  std::mt19937 generator(6);
  const Camera camera = Lens(CameraModel::kSimpleRadial, 1500);
  std::vector<SquareView> views = Draw(camera, 7, 1.0, 0.0, &generator);
  for (SquareView& view : views) view.sigma_px = 0.3;
  const double few = FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080, views).log_sigma;
  const std::vector<SquareView> more = Draw(camera, 1, 1.0, 0.0, &generator);
  views.insert(views.end(), more.begin(), more.end());
  views.back().sigma_px = 0.3;
  EXPECT_LT(FindFocalLength(CameraModel::kSimpleRadial, 1920, 1080, views).log_sigma, 0.5 * few);
}

}  // namespace
}  // namespace velamap
