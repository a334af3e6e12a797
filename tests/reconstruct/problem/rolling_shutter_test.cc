#include "reconstruct/problem/rolling_shutter.h"

#include <cmath>

#include <gmock/gmock.h>

#include "importer/camera/turned_camera.h"

namespace velamap {
namespace {

const Camera kLandscape{CameraModel::kSimplePinhole, 640, 480, {500, 320, 240}};

// A shake with an amplitude of 12 px, and a velocity across it.
Eigen::Vector2d PlaceAt(double time_s) {
  constexpr double kTurn_rad_s = 2 * 3.14159265358979 * 4;
  return {200 + 150 * time_s, 90 + 12 * std::sin(kTurn_rad_s * time_s + 0.8) - 100 * time_s};
}

// Where the corner is in the frame at `time_s`: its row decides the time that decides its row.
Eigen::Vector2d SeenAt(double time_s, double rolling_shutter_s) {
  Eigen::Vector2d x_px = PlaceAt(time_s);
  for (int k = 0; k < 30; ++k) {
    x_px = PlaceAt(time_s + rolling_shutter_s * (x_px.y() / kLandscape.height_px - 0.5));
  }
  return x_px;
}

TEST(ShiftByRow, LeadsBackToTheMiddleRow) {
  constexpr double kStep_s = 1e-4, kJerkStep_s = 1e-3;  // of numerical derivatives
  for (const double rolling_shutter_s : {0.015, -0.02}) {
    const Eigen::Vector2d x_px = SeenAt(0, rolling_shutter_s);
    const Eigen::Vector2d after_px = SeenAt(kStep_s, rolling_shutter_s);
    const Eigen::Vector2d before_px = SeenAt(-kStep_s, rolling_shutter_s);
    const auto differ_px = [&](double step_s) -> Eigen::Vector2d {
      return SeenAt(step_s, rolling_shutter_s) - SeenAt(-step_s, rolling_shutter_s);
    };
    const Eigen::Vector2d jerk_px_s3 =
        (differ_px(2 * kJerkStep_s) - 2 * differ_px(kJerkStep_s)) / (2 * std::pow(kJerkStep_s, 3));
    const CornerMotion motion{differ_px(kStep_s) / (2 * kStep_s),
                              (after_px + before_px - 2 * x_px) / (kStep_s * kStep_s), jerk_px_s3};
    const Eigen::Vector2d shift_px =
        ShiftByRow(RowMotionOf(kLandscape, x_px, motion), rolling_shutter_s).value_px;
    const Eigen::Vector2d expected_px = x_px - PlaceAt(0);
    EXPECT_GT(expected_px.norm(), 0.5);
    EXPECT_LT((shift_px - expected_px).norm(), 0.003);
    // Neither the acceleration nor the change of the row from frame to frame is negligible.
    const double row = x_px.y() / kLandscape.height_px - 0.5;
    EXPECT_GT((rolling_shutter_s * row * motion.velocity_px_s - expected_px).norm(), 0.05);
  }
}

TEST(ShiftByRow, PortraitFramesAreReadColumnByColumn) {
  const Camera portrait = TurnCamera(kLandscape, 1);
  const Eigen::Vector2d x_px(100, 30), velocity_px_s(70, -20), acceleration_px_s2(-3000, 5000);
  const Eigen::Vector2d turned_px = TurnInImage(kLandscape, 1, x_px);
  const auto turn = [&](const Eigen::Vector2d& vector) -> Eigen::Vector2d {
    return TurnInImage(kLandscape, 1, x_px + vector) - turned_px;
  };
  const auto shift_px = [](const Camera& camera, const Eigen::Vector2d& place_px,
                           const CornerMotion& motion, double rolling_shutter_s) {
    return ShiftByRow(RowMotionOf(camera, place_px, motion), rolling_shutter_s).value_px;
  };
  // Turned clockwise, the first row of the sensor is the last column.
  const Eigen::Vector2d found_px =
      shift_px(portrait, turned_px, {turn(velocity_px_s), turn(acceleration_px_s2)}, -0.02);
  const Eigen::Vector2d expected_px =
      turn(shift_px(kLandscape, x_px, {velocity_px_s, acceleration_px_s2}, 0.02));
  EXPECT_LT((found_px - expected_px).norm(), 1e-12);
}

TEST(MoveToMiddleRow, MovesImagesWhoseMotionIsKnown) {
  Model model;
  model.cameras[1] = kLandscape;
  ModelImage image;
  image.image_id = 7;
  image.camera_id = 1;
  for (const double y : {0.0, 240.0, 480.0}) image.points2D.push_back({{100, y}, 0});
  model.images = {image, image};
  model.images[1].image_id = 8;
  const CornerMotion motion{{50, 0}, {0, 0}};
  MoveToMiddleRow(0.02, {{7, {motion, motion, motion}}}, &model);
  const auto x_px = [&](int image_idx, int i) -> Eigen::Vector2d {
    return model.images[image_idx].points2D[i].x_in_image_px;
  };
  // Half the time before and after the middle row.
  EXPECT_LT((x_px(0, 0) - Eigen::Vector2d(100.5, 0)).norm(), 1e-12);
  EXPECT_EQ(x_px(0, 1), Eigen::Vector2d(100, 240));
  EXPECT_LT((x_px(0, 2) - Eigen::Vector2d(99.5, 480)).norm(), 1e-12);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(x_px(1, i), image.points2D[i].x_in_image_px);
}

}  // namespace
}  // namespace velamap
