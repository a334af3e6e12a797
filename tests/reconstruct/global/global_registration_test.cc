#include "reconstruct/global/global_registration.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/reconstruct/global/global_registration_fixture.h"
#include "tests/support/test_seed.h"

namespace velamap {
namespace {

using testing::HasSubstr;

class NoiseFreeGlobalRegistration : public testing::TestWithParam<RegistrationCase> {};

TEST_P(NoiseFreeGlobalRegistration, GivesTheTruthBack) {
  const SyntheticScene scene = MakeScene(GetParam().kind, 24, GetParam().video);
  const Registration registration = Register(scene);
  EXPECT_LT(MaxError(registration, scene), 1e-9);
  EXPECT_EQ(registration.NumRegistered(), 24);
  EXPECT_EQ(registration.shape.size(), scene.x_in_world.size());
  EXPECT_TRUE(registration.notes.empty());
  for (const RegisteredFrame& frame : registration.frames) {
    ASSERT_TRUE(frame.cam_from_shape);
    EXPECT_TRUE(frame.outliers.empty());
    EXPECT_LT((frame.cam_from_shape->translation -
               TrueCamFromShape(registration, scene, frame.image_id).translation)
                  .norm(),
              1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, NoiseFreeGlobalRegistration,
                         testing::Values(RegistrationCase{SceneKind::kSail, true},
                                         RegistrationCase{SceneKind::kSail, false},
                                         RegistrationCase{SceneKind::kPlane, true},
                                         RegistrationCase{SceneKind::kCube, false}));

TEST(GlobalRegistration, ScaleIsThatOfTheMedianMarker) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 12, false);
  for (const int marker_id : {3, 9, 17, 24}) {
    scene.layout.marker_lengths_m[marker_id] = 1.05 * scene.layout.marker_length_m;
  }
  const Registration registration = Register(scene);
  EXPECT_EQ(registration.shape.size(), scene.x_in_world.size());
  EXPECT_LT(RmsError(registration, scene), 1e-4);
}

TEST(GlobalRegistration, OrderAndIdsOfImagesChangeNothing) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 12, false);
  AddNoise({0.3, 0.05, 0.02, 200, 3}, &scene);
  auto images = DatabaseImages(scene);
  RegistrationOptions options;
  options.method = RegistrationMethod::kGlobal;
  const auto registration = RegisterFrames(images, SceneCameras(scene), scene.layout, options);
  std::shuffle(images.begin(), images.end(), std::mt19937(5));
  for (std::size_t i = 0; i < images.size(); ++i)
    images[i].image_id = static_cast<ImageId>(i + 100);
  const auto shuffled = RegisterFrames(images, SceneCameras(scene), scene.layout, options);
  EXPECT_EQ(shuffled.central_image_name, registration.central_image_name);
  ASSERT_EQ(shuffled.shape.size(), registration.shape.size());
  for (const auto& [marker_id, points] : registration.shape) {
    EXPECT_EQ(RmsDistance(points, shuffled.shape.at(marker_id)), 0.0);
  }
}

TEST(GlobalRegistration, TheNumberOfThreadsDecidesNothing) {
  SyntheticScene scene = MakeScene(SceneKind::kCube, 16, false);
  AddNoise({0.3, 0.05, 0.01, 200, 4}, &scene);
  RegistrationOptions options;
  options.num_threads = 1;
  const Registration expected = Register(scene, options);
  for (const int num_threads : {2, 5}) {
    options.num_threads = num_threads;
    const Registration registration = Register(scene, options);
    EXPECT_EQ(registration.shape, expected.shape) << num_threads;
    EXPECT_EQ(registration.notes, expected.notes) << num_threads;
    ASSERT_EQ(registration.frames.size(), expected.frames.size()) << num_threads;
    for (std::size_t i = 0; i < expected.frames.size(); ++i) {
      const auto &pose = registration.frames[i].cam_from_shape,
                 &expected_pose = expected.frames[i].cam_from_shape;
      ASSERT_EQ(pose.has_value(), expected_pose.has_value()) << num_threads;
      if (!pose) continue;
      EXPECT_EQ(pose->rotation.coeffs(), expected_pose->rotation.coeffs()) << num_threads;
      EXPECT_EQ(pose->translation, expected_pose->translation) << num_threads;
    }
  }
}

TEST(GlobalRegistration, SeedDecidesNothingThatMatters) {
  SyntheticScene scene = MakeScene(SceneKind::kCube, 24, false);
  AddNoise({0.2, 0.0, 0.03, 200, 3}, &scene);
  RegistrationOptions options;
  const Registration first = Register(scene, options);
  options.random_seed = 42;
  const Registration second = Register(scene, options);
  EXPECT_EQ(first.central_image_id, second.central_image_id);
  ASSERT_EQ(first.shape.size(), second.shape.size());
  for (const auto& [marker_id, points] : first.shape) {
    EXPECT_LT(RmsDistance(points, second.shape.at(marker_id)), 1e-4);
  }
}

TEST(GlobalRegistration, ReachesAllFacesOfTheCubeWithNoise) {
  SyntheticScene scene = MakeScene(SceneKind::kCube, 24, false);
  AddNoise({0.3, 0.1, 0.05, 100, 8}, &scene);
  const Registration registration = Register(scene);
  EXPECT_EQ(registration.NumRegistered(), 24);
  EXPECT_EQ(registration.shape.size(), scene.x_in_world.size());
  EXPECT_LT(RmsError(registration, scene), 0.005);
}

// The trap: nearly flat, far away through a long lens, small markers, poor corners.
SyntheticScene ShallowSail(std::uint32_t seed) {
  SyntheticSceneOptions options;
  options.num_frames = 16;
  options.num_columns = 5;
  options.num_rows = 4;
  options.spacing_m = 0.5;
  options.marker_length_m = 0.06;
  options.seed = seed;
  options.video = false;
  options.camera = {CameraModel::kPinhole, 1920, 1080, {1300, 1300, 960, 540}};
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.4, 0.0, 0.05, 100, seed}, &scene);
  return scene;
}

// A wrong shape is off by centimetres; the largest error of 60 draws is 2.7 mm. The right shape has
// no note.
TEST(GlobalRegistration, ShallowSailIsTheRightShapeWithoutANote) {
  std::mt19937 seeds(TestSeed());
  for (int draw = 0; draw < 8; ++draw) {
    const SyntheticScene scene = ShallowSail(seeds());
    const Registration registration = Register(scene);
    EXPECT_LT(RmsError(registration, scene), 0.006) << draw;
    EXPECT_TRUE(registration.notes.empty()) << draw;
    EXPECT_GE(ReconstructionRatio(registration, scene), 0.98) << draw;
  }
}

TEST(GlobalRegistration, LargerOfTwoGroupsIsUsed) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 10, false);
  for (std::size_t i = 0; i < 3; ++i) {
    for (auto& marker : scene.frames[i].markers) marker.marker_id += 500;
  }
  const Registration registration = Register(scene);
  EXPECT_EQ(registration.NumRegistered(), 7);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_THAT(registration.frames[i].left_out.reason, HasSubstr("shares 0 of its"));
  }
  int num_unseen = 0;
  for (const DroppedMarker& dropped : registration.dropped_markers) {
    if (dropped.marker_id < 500) continue;
    ++num_unseen;
    EXPECT_EQ(dropped.reason, "no registered frame shows it");
  }
  EXPECT_GT(num_unseen, 3);
}

TEST(GlobalRegistration, OfALongVideoTheBestFramesAreKept) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 60, true);
  BlurFrames(2.0, 6, &scene);
  RegistrationOptions options;
  options.global.max_num_frames = 12;
  options.central_frame = "31";
  const Registration registration = Register(scene, options);
  EXPECT_EQ(registration.NumRegistered(), 12);
  EXPECT_EQ(registration.central_image_name, "frame_000031.jpg");
  EXPECT_EQ(registration.shape.size(), scene.x_in_world.size());
  int first = 60, last = -1;
  for (int i = 0; i < 60; ++i) {
    const RegisteredFrame& frame = registration.frames[static_cast<std::size_t>(i)];
    if (!frame.cam_from_shape) {
      EXPECT_FALSE(frame.left_out.reason.empty());
      continue;
    }
    EXPECT_NE(i % 10, 5) << "a blurred frame was chosen";
    first = std::min(first, i);
    last = std::max(last, i);
  }
  EXPECT_LT(first, 8);  // the ends give the parallax
  EXPECT_GT(last, 52);
}

TEST(GlobalRegistration, AnyNumberOfFramesMayBeAllowed) {
  RegistrationOptions options;
  options.global.max_num_frames = std::numeric_limits<int>::max();
  const Registration registration = Register(MakeScene(SceneKind::kSail, 24, true), options);
  EXPECT_EQ(registration.NumRegistered(), 24);
}

TEST(GlobalRegistration, DataThatCannotBeRegisteredAreRefused) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 3, false);
  RegistrationOptions options;
  options.method = RegistrationMethod::kGlobal;
  auto images = DatabaseImages(scene);
  images.resize(1);
  EXPECT_THROW(RegisterFrames(images, SceneCameras(scene), scene.layout, options), DataError);
  for (std::size_t i = 0; i < 3; ++i) {
    for (auto& marker : scene.frames[i].markers) marker.marker_id += static_cast<int>(100 * i);
  }
  EXPECT_THROW(Register(scene), DataError);
}

TEST(GlobalRegistration, UnknownCentralFrameIsAnInputError) {
  const SyntheticScene scene = MakeScene(SceneKind::kSail, 4, true);
  RegistrationOptions options;
  options.central_frame = "17";
  EXPECT_THROW(Register(scene, options), InputError);
  options.central_frame = "2";
  EXPECT_EQ(Register(scene, options).central_image_name, "frame_000002.jpg");
}

}  // namespace
}  // namespace velamap
