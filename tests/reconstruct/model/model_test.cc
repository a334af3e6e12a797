#include "reconstruct/model/model.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

#include "tests/reconstruct/sheet_model.h"

namespace velamap {
namespace {

using testing::HasSubstr;

Model SmallModel() {
  SheetOptions options;
  options.num_rows = options.num_columns = 1;
  options.num_images = 3;
  return MakeSheetModel(options);
}

TEST(CheckModel, SoundModelPasses) { EXPECT_NO_THROW(CheckModel(SmallModel())); }

struct Fault {
  const char* name;
  const char* message;
  std::function<void(Model*)> inflict;
};

class CheckModelTest : public testing::TestWithParam<Fault> {};

TEST_P(CheckModelTest, FaultIsNamed) {
  Model model = SmallModel();
  GetParam().inflict(&model);
  EXPECT_THAT(FindModelFault(model), HasSubstr(GetParam().message));
  EXPECT_THROW(CheckModel(model), std::logic_error);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Faults, CheckModelTest,
    testing::Values(
        Fault{"DuplicateImage", "there are two images with the id 2",
              [](Model* m) { m->images.push_back(m->images[1]); }},
        Fault{"NoCamera", "image 2 has camera 7", [](Model* m) { m->images[1].camera_id = 7; }},
        Fault{"CameraParams", "camera 1 has 7 parameters",
              [](Model* m) { m->cameras.at(1).params.pop_back(); }},
        Fault{"CameraNan", "camera 1 has a parameter",
              [](Model* m) { m->cameras.at(1).params[0] = kNan; }},
        Fault{"CameraSize", "camera 1 has the size 0 x 1080",
              [](Model* m) { m->cameras.at(1).width_px = 0; }},
        Fault{"PoseNan", "image 1 has a pose",
              [](Model* m) { m->images[0].cam_from_world.translation.y() = kNan; }},
        Fault{"NoRotation", "image 1 has a pose",
              [](Model* m) { m->images[0].cam_from_world.rotation.coeffs() *= 1.01; }},
        Fault{"Point2DNan", "2D point 2 of image 3 is not finite",
              [](Model* m) { m->images[2].points2D[2].x_in_image_px.x() = kNan; }},
        Fault{"NoPoint", "observes point 99",
              [](Model* m) { m->images[2].points2D[2].point3D_id = 99; }},
        Fault{"PointNan", "point 12 is not finite",
              [](Model* m) { m->points3D.at(12).x_in_world.z() = kNan; }},
        Fault{"TrackImage", "the track of point 12 has image 9",
              [](Model* m) { m->points3D.at(12).track[0].image_id = 9; }},
        Fault{"TrackIdx", "which does not observe it",
              [](Model* m) { m->points3D.at(12).track[0].point2D_idx = 4; }},
        Fault{"TrackOther", "which does not observe it",
              [](Model* m) { m->points3D.at(12).track[0].point2D_idx = 0; }},
        Fault{"TrackTwice", "twice",
              [](Model* m) { m->points3D.at(12).track.push_back(m->points3D.at(12).track[0]); }},
        Fault{"Untracked", "point 12 is observed by 3 2D points, but its track has 2",
              [](Model* m) { m->points3D.at(12).track.pop_back(); }}),
    [](const auto& test) { return test.param.name; });

TEST(FindImage, FindsByIdOnly) {
  const Model model = SmallModel();
  ASSERT_NE(model.FindImage(2), nullptr);
  EXPECT_EQ(model.FindImage(2)->image_id, 2u);
  EXPECT_EQ(model.FindImage(4), nullptr);
}

TEST(RemoveObservation, LeavesASoundModelWithOneObservationLess) {
  Model model = SmallModel();
  RemoveObservation(&model, 13, model.points3D.at(13).track[1]);
  CheckModel(model);
  EXPECT_EQ(model.points3D.at(13).track.size(), 2u);
  EXPECT_EQ(model.images[1].points2D[2].point3D_id, kInvalidPoint3DId);
  EXPECT_THROW(RemoveObservation(&model, 13, {2, 2}), std::logic_error);
}

TEST(RemoveShortTracks, RemovesPointsAndReferences) {
  Model model = SmallModel();
  for (int i = 0; i < 2; ++i) RemoveObservation(&model, 11, model.points3D.at(11).track[0]);
  RemoveObservation(&model, 14, model.points3D.at(14).track[0]);
  RemoveShortTracks(&model, 2);
  CheckModel(model);
  EXPECT_EQ(model.points3D.count(11), 0u);
  EXPECT_EQ(model.points3D.count(14), 1u);
  EXPECT_EQ(model.points3D.size(), 3u);
  EXPECT_EQ(model.images[2].points2D.size(), 4u);
}

}  // namespace
}  // namespace velamap
