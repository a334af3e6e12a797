#include "reconstruct/geometry/camera_conversion.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace velamap {
namespace {

double Distance(const Camera& a, const Camera& b) {
  double largest_px = 0.0;
  for (double x = 10; x < a.width_px; x += 100) {
    for (double y = 10; y < a.height_px; y += 100) {
      const auto ray = CamFromImage(a, {x, y});
      if (!ray) continue;
      const auto there = ImageFromCam(b, ray->homogeneous());
      if (there) largest_px = std::max(largest_px, (*there - Eigen::Vector2d(x, y)).norm());
    }
  }
  return largest_px;
}

TEST(CameraConversion, IsExactWhereTheModelContainsTheCamera) {
  const Camera radial{CameraModel::kSimpleRadial, 1280, 720, {900, 650, 350, -0.08}};
  for (const CameraModel model : {CameraModel::kRadial, CameraModel::kOpenCV}) {
    EXPECT_LT(Distance(radial, ConvertCamera(radial, model)), 1e-5) << CameraModelName(model);
  }
}

TEST(CameraConversion, IsCloseBetweenLensesThatResembleEachOther) {
  const Camera wide{CameraModel::kOpenCV, 1920, 1080, {875, 875, 964, 537, -0.245, 0.07, 0, 0}};
  const Camera fisheye = ConvertCamera(wide, CameraModel::kOpenCVFisheye);
  EXPECT_EQ(fisheye.model, CameraModel::kOpenCVFisheye);
  EXPECT_LT(Distance(wide, fisheye), 0.005 * wide.width_px);
}

}  // namespace
}  // namespace velamap
