#include "importer/camera/turned_camera.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

const std::vector<Camera> kCameras = {
    {CameraModel::kSimpleRadial, 4000, 3000, {3100, 1980, 1530, -0.1}},
    {CameraModel::kPinhole, 4000, 3000, {3100, 3050, 1980, 1530}},
    {CameraModel::kOpenCV, 4000, 3000, {3100, 3050, 1980, 1530, -0.2, 0.05, 3e-3, -2e-3}},
    {CameraModel::kFullOpenCV,
     4000,
     3000,
     {3100, 3050, 1980, 1530, -0.2, 0.05, 3e-3, -2e-3, 0.01, 0.1, 0.02, 0.003}},
    {CameraModel::kOpenCVFisheye, 4000, 3000, {1500, 1510, 1980, 1530, 0.03, -0.01, 2e-3, 1e-3}}};

TEST(TurnedCamera, SeesTheTurnedPicture) {
  const Eigen::Vector3d x(0.3, -0.4, 1.2);
  for (const Camera& camera : kCameras) {
    for (int turns = -4; turns <= 4; ++turns) {
      // The camera itself is turned the same way, so that the picture shows the same scene.
      Eigen::Vector3d x_turned = x;
      for (int i = 0; i < (turns + 4) % 4; ++i) x_turned = {-x_turned.y(), x_turned.x(), x.z()};
      const Camera turned = TurnCamera(camera, turns);
      const auto before = ImageFromCam(camera, x), after = ImageFromCam(turned, x_turned);
      ASSERT_TRUE(before && after);
      EXPECT_LT((TurnInImage(camera, turns, *before) - *after).norm(), 1e-9)
          << CameraModelName(camera.model) << " " << turns;
      EXPECT_EQ(turned.width_px, turns % 2 == 0 ? 4000 : 3000);
    }
  }
}

TEST(TurnedCamera, FourQuartersChangeNothing) {
  for (const Camera& camera : kCameras) {
    EXPECT_EQ(TurnCamera(camera, 4), camera);
    const Camera back = TurnCamera(TurnCamera(camera, 1), -1);
    for (std::size_t i = 0; i < camera.params.size(); ++i) {
      EXPECT_NEAR(back.params[i], camera.params[i], 1e-9);
    }
  }
}

TEST(TurnedCamera, RecognizesTransposedSizes) {
  const Camera& camera = kCameras.front();
  EXPECT_TRUE(IsTransposedSize(camera, 3000, 4000));
  EXPECT_TRUE(IsTransposedSize(camera, 1500, 2000));
  EXPECT_FALSE(IsTransposedSize(camera, 4000, 3000));
  EXPECT_FALSE(IsTransposedSize(camera, 2250, 4000));
  EXPECT_FALSE(IsTransposedSize(camera, 3000, 3000));
}

}  // namespace
}  // namespace velamap
