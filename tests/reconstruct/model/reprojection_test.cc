#include "reconstruct/model/reprojection.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

TEST(ComputeReprojectionErrors, ExactModelHasNone) {
  for (const CameraModel camera_model :
       {CameraModel::kOpenCV, CameraModel::kPinhole, CameraModel::kSimpleRadial}) {
    SheetOptions options;
    options.camera_model = camera_model;
    const Model model = MakeSheetModel(options);
    const Statistics statistics = SummarizeReprojectionErrors(model);
    EXPECT_EQ(statistics.count, 9 * 80);
    EXPECT_LT(statistics.max, 1e-9);
  }
}

TEST(ComputeReprojectionErrors, ResidualIsProjectionMinusObservation) {
  Model model = MakeSheetModel();
  model.images[3].points2D[5].x_in_image_px += Eigen::Vector2d(3, -4);
  int num_affected = 0;
  for (const ObservationError& error : ComputeReprojectionErrors(model)) {
    if (error.error_px < 1e-9) continue;
    ++num_affected;
    EXPECT_EQ(error.element.image_id, 4u);
    EXPECT_EQ(error.element.point2D_idx, 5u);
    EXPECT_EQ(error.point3D_id, 22u);
    EXPECT_NEAR(error.residual_in_image_px.x(), -3, 1e-9);
    EXPECT_NEAR(error.residual_in_image_px.y(), 4, 1e-9);
    EXPECT_NEAR(error.error_px, 5, 1e-9);
  }
  EXPECT_EQ(num_affected, 1);
}

TEST(ComputeReprojectionErrors, OrderedByPointThenTrack) {
  const Model model = MakeSheetModel();
  const auto errors = ComputeReprojectionErrors(model);
  std::size_t i = 0;
  for (const auto& [point3D_id, point] : model.points3D) {
    for (const TrackElement& element : point.track) {
      ASSERT_EQ(errors[i].point3D_id, point3D_id);
      ASSERT_EQ(errors[i].element.image_id, element.image_id);
      ++i;
    }
  }
  EXPECT_EQ(i, errors.size());
}

TEST(ComputeReprojectionErrors, PointBehindTheCameraIsInfinitelyWrong) {
  Model model = MakeSheetModel();
  Point3D& point = model.points3D.at(11);
  point.x_in_world *= -100;
  for (const ObservationError& error : ComputeReprojectionErrors(model)) {
    const bool behind =
        error.point3D_id == 11 &&
        (model.FindImage(error.element.image_id)->cam_from_world * point.x_in_world).z() <= 0;
    EXPECT_EQ(std::isinf(error.error_px), behind);
  }
}

TEST(UpdatePointErrors, ReplacesStaleErrorsByTheMeanOverTheTrack) {
  Model model = MakeSheetModel();
  for (auto& [point3D_id, point] : model.points3D) point.mean_error_px = 77;
  model.images[0].points2D[1].x_in_image_px.x() += 9;
  model.images[1].points2D[1].x_in_image_px.y() -= 18;
  UpdatePointErrors(&model);
  EXPECT_NEAR(model.points3D.at(12).mean_error_px, 3, 1e-9);
  EXPECT_NEAR(model.points3D.at(13).mean_error_px, 0, 1e-9);
}

}  // namespace
}  // namespace velamap
