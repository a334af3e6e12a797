#include "reconstruct/model/weak_geometry.h"

#include <gmock/gmock.h>

#include "reconstruct/adjust/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// The scene seen by cameras at these places (world, m) that look at `targets`.
SyntheticScene SeenFrom(SceneKind kind, const std::vector<Eigen::Vector3d>& places,
                        const std::vector<Eigen::Vector3d>& targets) {
  SyntheticSceneOptions options;
  options.kind = kind;
  options.num_rows = 3;
  options.num_columns = 4;
  options.num_frames = static_cast<int>(places.size());
  SyntheticScene scene = MakeSyntheticScene(options);
  FrameDetections all;
  for (const auto& [marker_id, points] : scene.x_in_world) {
    MarkerDetection marker;
    marker.marker_id = marker_id;
    all.markers.push_back(marker);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d z = (targets[i] - places[i]).normalized();
    const Eigen::Vector3d x = Eigen::Vector3d(0, 0, -1).cross(z).normalized();
    Eigen::Matrix3d rotation;
    rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
    scene.cam_from_world[i] = {Eigen::Quaterniond(rotation), -(rotation * places[i])};
    scene.frames[i].markers = all.markers;
  }
  ProjectAnew(&scene);
  AddNoise({0.1, 0, 0, 200, 1}, &scene);
  return scene;
}

std::vector<std::string> WarningsOf(const SyntheticScene& scene,
                                    const MarkerAdjustmentOptions& options = {}) {
  Model model = MakeSceneModel(scene);
  return AdjustWithMarkers(options, scene.layout, {}, &model).warnings;
}

TEST(WeakGeometry, ViewsFromAllSidesAreFine) {
  EXPECT_THAT(WarningsOf(SeenFrom(SceneKind::kSail,
                                  {{-1, -1.5, 0}, {0, -1.8, 0.5}, {1, -1.5, 0}, {0, -1.7, -0.6}},
                                  std::vector<Eigen::Vector3d>(4, {0, 0, 0}))),
              IsEmpty());
}

TEST(WeakGeometry, PureRotationIsAllFromOnePlace) {
  EXPECT_THAT(
      WarningsOf(SeenFrom(SceneKind::kSail, std::vector<Eigen::Vector3d>(5, {0, -2, 0}),
                          {{0, 0, 0}, {0.1, 0, 0}, {-0.1, 0, 0.1}, {0, 0, -0.1}, {0.1, 0, 0.1}})),
      ElementsAre(HasSubstr("all images are taken from one place")));
}

TEST(WeakGeometry, FlatBoardHeadOnIsNamed) {
  EXPECT_THAT(WarningsOf(SeenFrom(SceneKind::kPlane,
                                  {{0, -2, 0}, {0.02, -2.1, 0}, {0, -1.9, 0.02}, {0, -2.3, 0}},
                                  std::vector<Eigen::Vector3d>(4, {0, 0, 0}))),
              ElementsAre(HasSubstr("a flat object is seen head-on")));
}

TEST(WeakGeometry, LittleParallaxIsNamed) {
  const std::vector<std::string> warnings = WarningsOf(
      SeenFrom(SceneKind::kSail, {{0, -2, 0}, {0.06, -2, 0}, {0, -2, 0.06}, {0.03, -2, 0.03}},
               std::vector<Eigen::Vector3d>(4, {0, 0, 0})));
  ASSERT_THAT(warnings, ElementsAre(HasSubstr("hardly any parallax")));
  EXPECT_TRUE(IsWeakGeometryWarning(warnings.front()));
  EXPECT_FALSE(IsWeakGeometryWarning("another warning"));
}

// The camera moves enough, but most markers are readable only from nearly one place.
TEST(WeakGeometry, MarkersThatMostImagesDoNotShowAreNoLackOfMotion) {
  constexpr std::size_t kNumNear = 4;
  const std::vector<Eigen::Vector3d> places = {{0, -2, 0},       {0.06, -2, 0},   {0, -2, 0.06},
                                               {0.03, -2, 0.03}, {-0.8, -1.8, 0}, {0.8, -1.8, 0}};
  SyntheticScene scene =
      SeenFrom(SceneKind::kSail, places, std::vector<Eigen::Vector3d>(places.size(), {0, 0, 0}));
  for (std::size_t i = kNumNear; i < places.size(); ++i) scene.frames[i].markers.resize(4);
  const std::vector<std::string> warnings = WarningsOf(scene);
  ASSERT_THAT(warnings, ElementsAre(HasSubstr("most images do not show their markers")));
  EXPECT_THAT(warnings.front(), Not(HasSubstr("take images from places")));
  EXPECT_TRUE(IsWeakGeometryWarning(warnings.front()));
}

TEST(WeakGeometry, AnUncertainScaleIsNoLackOfParallax) {
  MarkerAdjustmentOptions options;
  options.common_print_tolerance = 0.05;
  const auto scene =
      SeenFrom(SceneKind::kSail, {{-0.25, -2, 0}, {0.25, -2, 0}, {0, -2, 0.25}, {0, -2, -0.25}},
               std::vector<Eigen::Vector3d>(4, {0, 0, 0}));
  EXPECT_THAT(WarningsOf(scene, options), IsEmpty());
}

}  // namespace
}  // namespace velamap
