#include "reconstruct/register_frames.h"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "reconstruct/thesis/frame_selection.h"
#include "tests/reconstruct/registration_fixture.h"

namespace velamap {
namespace {

RegistrationOptions ThesisOptions() {
  RegistrationOptions options;
  options.method = RegistrationMethod::kThesis;
  return options;
}

Registration RegisterAsThesis(const SyntheticScene& scene,
                              const RegistrationOptions& options = ThesisOptions()) {
  return RegisterFrames(DatabaseImages(scene), SceneCameras(scene), scene.layout, options);
}

class NoiseFreeRegistration : public testing::TestWithParam<RegistrationCase> {};

TEST_P(NoiseFreeRegistration, GivesTheTruthBack) {
  const SyntheticScene scene = MakeScene(GetParam().kind, 24, GetParam().video);
  const Registration registration = RegisterAsThesis(scene);
  EXPECT_LT(MaxError(registration, scene), 1e-9);
  EXPECT_GE(registration.NumRegistered(), 20);
  for (const RegisteredFrame& frame : registration.frames) {
    if (!frame.cam_from_shape) continue;
    EXPECT_TRUE(frame.outliers.empty());
    EXPECT_LT((frame.cam_from_shape->translation -
               TrueCamFromShape(registration, scene, frame.image_id).translation)
                  .norm(),
              1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, NoiseFreeRegistration,
                         testing::Values(RegistrationCase{SceneKind::kSail, true},
                                         RegistrationCase{SceneKind::kSail, false},
                                         RegistrationCase{SceneKind::kPlane, true},
                                         RegistrationCase{SceneKind::kCube, false}));

RegistrationOptions ExactOptions() {
  RegistrationOptions options = ThesisOptions();
  options.thesis.variant = ThesisVariant::kExact;
  return options;
}

// What equation 3.5 leaves between the centre of a frame's markers and that of their mean places,
// m: nothing, because the best translation maps one centre onto the other.
double MaxCenterOffset(const Registration& registration, const SyntheticScene& scene) {
  double max_offset_m = 0.0;
  const std::vector<FrameShape> frames = FrameShapes(scene);
  for (const RegisteredFrame& frame : registration.frames) {
    if (!frame.cam_from_shape) continue;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int marker_id : frame.marker_ids) {
      const FrameMarker* marker = FindMarkerById(frames[frame.image_id - 1].markers, marker_id);
      sum +=
          *frame.cam_from_shape * registration.shape.at(marker_id)[0] - marker->x_in_cam.front()[0];
    }
    max_offset_m = std::max(max_offset_m, sum.norm());
  }
  return max_offset_m;
}

TEST(ExactThesis, GivesTheTruthBackWithoutNoise) {
  const SyntheticScene scene = MakeScene(SceneKind::kSail, 60, true);
  const Registration registration = RegisterAsThesis(scene, ExactOptions());
  EXPECT_LT(MaxError(registration, scene), 1e-9);
}

TEST(ExactThesis, CamerasAlignTheCentersOfTheirMarkersWithTheMean) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 60, true);
  AddNoise({0.3, 0.0, 0.0, 200, 3}, &scene);
  EXPECT_LT(MaxCenterOffset(RegisterAsThesis(scene, ExactOptions()), scene), 1e-9);
  EXPECT_GT(MaxCenterOffset(RegisterAsThesis(scene), scene),
            1e-6);  // robust: judges markers in the image
}

TEST(ExactThesis, DoesNotAdaptTheSkipToAShortVideo) {
  const SyntheticScene scene = MakeScene(SceneKind::kSail, 60, true);
  const Registration exact = RegisterAsThesis(scene, ExactOptions());
  EXPECT_LT(exact.NumRegistered(), 12);  // a skip of 10 has room for six frames
  EXPECT_GT(RegisterAsThesis(scene).NumRegistered(), 20);
}

TEST(ExactThesis, MarkersThatRansacRefusesLeaveTheirFrame) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 60, true);
  RegistrationOptions options = ExactOptions();
  options.central_frame = "30";
  options.thesis.skip = 1;
  options.thesis.neighborhood = 0;
  // Two markers of one frame change their names.
  auto& markers = scene.frames[31].markers;
  ASSERT_GT(markers.size(), 4u);
  std::swap(markers.front().corners_in_image_px, markers.back().corners_in_image_px);
  const Registration registration = RegisterAsThesis(scene, options);
  const RegisteredFrame& frame = registration.frames[31];
  ASSERT_EQ(frame.outliers.size(), 2u);
  EXPECT_EQ(frame.outliers[0].marker_id, markers.front().marker_id);
  EXPECT_EQ(frame.outliers[1].marker_id, markers.back().marker_id);
  EXPECT_LT(MaxError(registration, scene), 1e-9);
}

TEST(Registration, ImagesThatShareNothingWithTheCentralOneAreReachedThroughOthers) {
  const SyntheticScene scene = MakeScene(SceneKind::kCube, 24, false);
  const Registration registration = RegisterAsThesis(scene);
  EXPECT_EQ(registration.NumRegistered(), 24);
  const auto frames = FrameShapes(scene);
  int num_without_shared = 0;
  const FrameShape& central = frames[static_cast<std::size_t>(CentralIdx(registration))];
  for (const FrameShape& frame : frames)
    num_without_shared += NumSharedMarkers(frame, central) == 0;
  EXPECT_GT(num_without_shared, 0);
}

TEST(Registration, OrderAndIdsOfImagesChangeNothing) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 12, false);
  AddNoise({0.3, 0.05, 0.02, 200, 3}, &scene);
  auto images = DatabaseImages(scene);
  const Registration registration =
      RegisterFrames(images, SceneCameras(scene), scene.layout, ThesisOptions());
  std::shuffle(images.begin(), images.end(), std::mt19937(5));
  for (std::size_t i = 0; i < images.size(); ++i)
    images[i].image_id = static_cast<ImageId>(i + 100);
  const Registration shuffled =
      RegisterFrames(images, SceneCameras(scene), scene.layout, ThesisOptions());
  EXPECT_EQ(shuffled.central_image_name, registration.central_image_name);
  ASSERT_EQ(shuffled.shape.size(), registration.shape.size());
  for (const auto& [marker_id, points] : registration.shape) {
    EXPECT_EQ(RmsDistance(points, shuffled.shape.at(marker_id)), 0.0);
  }
}

TEST(Registration, SeedDecidesNothingThatMatters) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 41, true);
  AddNoise({0.2, 0.0, 0.03, 200, 3}, &scene);
  RegistrationOptions options = ThesisOptions();
  const Registration first = RegisterAsThesis(scene, options);
  options.random_seed = 42;
  const Registration second = RegisterAsThesis(scene, options);
  EXPECT_EQ(first.central_image_id, second.central_image_id);
  ASSERT_EQ(first.shape.size(), second.shape.size());
  for (const auto& [marker_id, points] : first.shape) {
    EXPECT_LT(RmsDistance(points, second.shape.at(marker_id)), 0.002);
  }
}

TEST(Registration, MisplacedMarkersAreLeftOutOfTheirFrames) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 21, true);
  AddNoise({0.1, 0.0, 0.05, 300, 9}, &scene);
  const Registration registration = RegisterAsThesis(scene);
  int num_outliers = 0;
  for (const RegisteredFrame& frame : registration.frames) {
    num_outliers += static_cast<int>(frame.outliers.size());
  }
  EXPECT_GE(num_outliers, 10);
  EXPECT_LT(MaxError(registration, scene), 0.03);
}

TEST(Registration, WrongFrameIsLeftOutWithAReason) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 8, false);
  // Ids of one image are permuted: every marker is in the wrong place.
  auto& markers = scene.frames[3].markers;
  const std::size_t count = markers.size();
  std::vector<int> ids;
  for (const auto& marker : markers) ids.push_back(marker.marker_id);
  for (std::size_t i = 0; i < count; ++i) markers[i].marker_id = ids[count - 1 - i];
  std::sort(markers.begin(), markers.end(),
            [](const auto& a, const auto& b) { return a.marker_id < b.marker_id; });
  std::vector<MarkerDetection> irregular;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 3 != 1) irregular.push_back(markers[(i * 7) % count]);
  }
  for (std::size_t i = 0; i < irregular.size(); ++i) irregular[i].marker_id = ids[i];
  markers = irregular;
  RegistrationOptions options = ThesisOptions();
  options.min_num_inliers = 5;
  const Registration registration = RegisterAsThesis(scene, options);
  EXPECT_FALSE(registration.frames[3].cam_from_shape);
  EXPECT_THAT(registration.frames[3].left_out.reason, testing::HasSubstr("do not agree"));
  EXPECT_EQ(registration.NumRegistered(), 7);
}

TEST(Registration, SecondGroupOfImagesIsReported) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 10, false);
  for (std::size_t i = 7; i < 10; ++i) {
    for (auto& marker : scene.frames[i].markers) marker.marker_id += 500;
  }
  const Registration registration = RegisterAsThesis(scene);
  EXPECT_EQ(registration.NumRegistered(), 7);
  for (std::size_t i = 7; i < 10; ++i) {
    EXPECT_THAT(registration.frames[i].left_out.reason, testing::HasSubstr("shares 0 of its"));
  }
}

TEST(Registration, RareMarkersAreDroppedFromAVideo) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 21, true);
  const int rare = 14;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    auto& markers = scene.frames[i].markers;
    if (i % 7 == 0) continue;
    markers.erase(std::remove_if(markers.begin(), markers.end(),
                                 [](const auto& m) { return m.marker_id == rare; }),
                  markers.end());
  }
  const Registration registration = RegisterAsThesis(scene);
  EXPECT_EQ(registration.shape.count(rare), 0u);
  ASSERT_EQ(registration.dropped_markers.size(), 1u);
  EXPECT_EQ(registration.dropped_markers[0].marker_id, rare);
  EXPECT_EQ(registration.dropped_markers[0].num_frames, 3);
}

TEST(Registration, DataThatCannotBeRegisteredAreRefused) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, 3, false);
  auto images = DatabaseImages(scene);
  images.resize(1);
  EXPECT_THROW(RegisterFrames(images, SceneCameras(scene), scene.layout, ThesisOptions()),
               DataError);
  for (std::size_t i = 0; i < 3; ++i) {
    for (auto& marker : scene.frames[i].markers) marker.marker_id += static_cast<int>(100 * i);
  }
  EXPECT_THROW(RegisterAsThesis(scene), DataError);
}

TEST(Registration, UnknownCentralFrameIsAnInputError) {
  const SyntheticScene scene = MakeScene(SceneKind::kSail, 3, true);
  RegistrationOptions options = ThesisOptions();
  options.central_frame = "17";
  EXPECT_THROW(RegisterAsThesis(scene, options), InputError);
  options.central_frame = "2";
  EXPECT_EQ(RegisterAsThesis(scene, options).central_image_name, "frame_000002.jpg");
}

}  // namespace
}  // namespace velamap
