#include "importer/camera/camera.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

#include "importer/camera/camera_jacobian.h"

namespace velamap {
namespace {

// One camera of each model, wide-angle and visibly distorted.
std::vector<Camera> AllModels() {
  return {
      {CameraModel::kSimplePinhole, 1920, 1080, {1300, 955.5, 548.25}},
      {CameraModel::kPinhole, 1920, 1080, {1300, 1310, 955.5, 548.25}},
      {CameraModel::kSimpleRadial, 1920, 1080, {1300, 955.5, 548.25, -0.12}},
      {CameraModel::kRadial, 1920, 1080, {1300, 955.5, 548.25, -0.12, 0.03}},
      {CameraModel::kOpenCV, 1920, 1080, {1300, 1310, 955.5, 548.25, -0.21, 0.05, 1.3e-3, -0.8e-3}},
      {CameraModel::kOpenCVFisheye,
       1920,
       1080,
       {800, 805, 955.5, 548.25, 0.02, -0.01, 0.003, -0.001}},
      {CameraModel::kFullOpenCV,
       1920,
       1080,
       {1300, 1310, 955.5, 548.25, 0.3, -0.15, 1.3e-3, -0.8e-3, 0.02, 0.45, -0.1, 0.03}}};
}

std::vector<Eigen::Vector3d> PointsInCam() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(-0.7, 0.7), y(-0.4, 0.4), z(0.5, 8.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 100; ++i) {
    const double depth = z(random);
    points.emplace_back(x(random) * depth, y(random) * depth, depth);
  }
  return points;
}

TEST(Camera, ImageFromCamAndCamFromImageAreInverse) {
  for (const Camera& camera : AllModels()) {
    for (const Eigen::Vector3d& x_in_cam : PointsInCam()) {
      const std::optional<Eigen::Vector2d> x_in_image_px = ImageFromCam(camera, x_in_cam);
      ASSERT_TRUE(x_in_image_px);
      const std::optional<Eigen::Vector2d> ray = CamFromImage(camera, *x_in_image_px);
      ASSERT_TRUE(ray) << CameraModelName(camera.model);
      EXPECT_LT((*ray - x_in_cam.head<2>() / x_in_cam.z()).norm(), 1e-9)
          << CameraModelName(camera.model);
    }
  }
}

TEST(Camera, JacobiansAgreeWithCentralDifferences) {
  constexpr double kStep = 1e-6;
  for (const Camera& camera : AllModels()) {
    const std::size_t num_before_distortion = NumFocalLengths(camera.model) + 2;
    for (const Eigen::Vector3d& x_in_cam : PointsInCam()) {
      const Eigen::Vector2d ray = x_in_cam.hnormalized();
      const RayFunction image = ImageFromRayWithJacobian(camera.model, camera.params.data(), ray);
      const RayFunction distorted =
          DistortRayWithJacobian(camera.model, camera.params.data() + num_before_distortion, ray);
      EXPECT_LT((image.value - *ImageFromCam(camera, ray.homogeneous())).norm(), 1e-9);
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
        const auto after = ImageFromCam(camera, (ray + step).homogeneous());
        const auto before = ImageFromCam(camera, (ray - step).homogeneous());
        const Eigen::Vector2d difference = (*after - *before) / (2 * kStep);
        EXPECT_LT((image.by_ray.col(axis) - difference).norm(), 1e-5 * difference.norm())
            << CameraModelName(camera.model);
        const Eigen::Vector2d focal(camera.params[0],
                                    camera.params[NumFocalLengths(camera.model) - 1]);
        EXPECT_LT((focal.cwiseProduct(distorted.by_ray.col(axis)) - difference).norm(),
                  1e-5 * difference.norm())
            << CameraModelName(camera.model);
      }
    }
  }
}

TEST(Camera, JacobianOfTheFisheyeOnItsAxis) {
  const Camera camera = AllModels()[5];
  const RayFunction image =
      ImageFromRayWithJacobian(camera.model, camera.params.data(), Eigen::Vector2d::Zero());
  EXPECT_TRUE(image.by_ray.isApprox(
      Eigen::Vector2d(camera.params[0], camera.params[1]).asDiagonal().toDenseMatrix(), 1e-12));
}

TEST(Camera, AgreesWithOpenCvAfterTheHalfPixelShift) {
  for (const Camera& camera : AllModels()) {
    const std::vector<double>& p = camera.params;
    const bool fisheye = camera.model == CameraModel::kOpenCVFisheye;
    if (p.size() < 8) continue;  // OpenCV has no models with one focal length
    const cv::Matx33d matrix(p[0], 0, p[2] - 0.5, 0, p[1], p[3] - 0.5, 0, 0, 1);
    const std::vector<double> distortion(p.begin() + 4, p.end());
    for (const Eigen::Vector3d& x : PointsInCam()) {
      const std::vector<cv::Point3d> points = {{x.x(), x.y(), x.z()}};
      const cv::Vec3d zero(0, 0, 0);
      std::vector<cv::Point2d> projected;
      if (fisheye) {
        cv::fisheye::projectPoints(points, projected, zero, zero, matrix, distortion);
      } else {
        cv::projectPoints(points, zero, zero, matrix, distortion, projected);
      }
      const Eigen::Vector2d ours = ImageFromCam(camera, x).value();
      EXPECT_NEAR(ours.x(), projected[0].x + 0.5, 1e-9) << CameraModelName(camera.model);
      EXPECT_NEAR(ours.y(), projected[0].y + 0.5, 1e-9) << CameraModelName(camera.model);
    }
  }
}

TEST(Camera, PointBehindTheCameraHasNoImage) {
  const Camera camera = AllModels()[1];
  EXPECT_FALSE(ImageFromCam(camera, {0.1, 0.2, -1.0}));
  EXPECT_FALSE(ImageFromCam(camera, {0.1, 0.2, 0.0}));
}

TEST(Camera, DistortionThatFoldsOverHasNoInverse) {
  // r (1 - 0.5 r^2) never exceeds 0.55, so an image radius of 0.8 focal lengths has no ray.
  const Camera camera{CameraModel::kSimpleRadial, 2000, 2000, {1000, 1000, 1000, -0.5}};
  EXPECT_FALSE(CamFromImage(camera, {1800, 1000}));
  EXPECT_TRUE(CamFromImage(camera, {1400, 1000}));
}

TEST(Camera, MonotonicDistortionEndsWhereItFoldsInsideTheImage) {
  for (const Camera& camera : AllModels()) {
    EXPECT_TRUE(HasMonotonicDistortion(camera)) << CameraModelName(camera.model);
  }
  // r (1 - 0.5 r^2) turns at r = 0.816, where the image is 544 px from the principal point.
  for (const int half_size_px : {300, 370, 400, 700, 1000}) {
    const double center_px = half_size_px;
    const Camera camera{CameraModel::kSimpleRadial,
                        2 * half_size_px,
                        2 * half_size_px,
                        {1000, center_px, center_px, -0.5}};
    EXPECT_EQ(HasMonotonicDistortion(camera), half_size_px * std::sqrt(2.0) < 544.0)
        << half_size_px;
  }
  // Numerator and denominator cancel each other but for a pole, a ten-thousandth of the field wide.
  const Camera pole{CameraModel::kFullOpenCV,
                    1920,
                    1080,
                    {1300, 1300, 960, 540, -3.0001, 0, 0, 0, 0, -3.0, 0, 0}};
  EXPECT_FALSE(HasMonotonicDistortion(pole));
}

TEST(Camera, MaxRayLengthIsThatOfTheFarthestCorner) {
  const Camera camera{CameraModel::kPinhole, 300, 400, {100, 100, 100, 200}};
  EXPECT_NEAR(MaxRayLength(camera), std::hypot(2.0, 2.0), 1e-9);
}

TEST(Camera, NamesAndIdsAreThoseOfColmap) {
  EXPECT_EQ(CameraModelName(CameraModel::kFullOpenCV), "FULL_OPENCV");
  for (const Camera& camera : AllModels()) {
    EXPECT_EQ(CameraModelFromName(CameraModelName(camera.model)), camera.model);
    EXPECT_EQ(CameraModelFromId(static_cast<int>(camera.model)), camera.model);
    EXPECT_EQ(NumCameraParams(camera.model), static_cast<int>(camera.params.size()));
  }
  EXPECT_FALSE(CameraModelFromName("opencv"));
  EXPECT_FALSE(CameraModelFromId(7));
}

}  // namespace
}  // namespace velamap
