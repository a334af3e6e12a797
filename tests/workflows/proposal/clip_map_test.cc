#include "workflows/proposal/clip_map.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include "importer/database/colmap_database.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNoisePx = 0.05;

SyntheticScene MakeSail() {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 5;
  options.num_frames = 12;
  SyntheticScene scene = MakeSyntheticScene(options);
  SyntheticNoiseOptions noise;
  noise.corner_sigma_px = kNoisePx;
  AddNoise(noise, &scene);
  return scene;
}

// Shows the markers with other sides than they have.
void Resize(double factor, const std::set<int>& ids, SyntheticScene* scene) {
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    for (MarkerDetection& marker : scene->frames[i].markers) {
      if (ids.count(marker.marker_id) == 0) continue;
      const auto& points = scene->x_in_world.at(marker.marker_id);
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        const Eigen::Vector3d true_x = points[c + 1];
        const Eigen::Vector3d x = points[0] + factor * (true_x - points[0]);
        const Rigid3& cam_from_world = scene->cam_from_world[i];
        marker.corners_in_image_px[c] += *ImageFromCam(scene->camera, cam_from_world * x) -
                                         *ImageFromCam(scene->camera, cam_from_world * true_x);
      }
    }
  }
}

ClipMap MapOf(const SyntheticScene& scene, const Layout& layout) {
  const TempDir dir;
  const std::string path = (dir.path() / "clip.db").string();
  {
    ColmapDatabase database(path, ColmapDatabase::Mode::kReadWriteCreate);
    const CameraId camera_id = database.AddCamera(scene.camera);
    for (const FrameDetections& frame : scene.frames) database.AddImage(camera_id, frame, "test");
  }
  return MapClip(path, layout, 1);
}

Layout Plain() { return MakeLayout("DICT_5X5_1000", 0.1); }

TEST(ClipMap, HoldsAllMarkersWithTheirSides) {
  const ClipMap map = MapOf(MakeSail(), Plain());
  ASSERT_EQ(map.bodies.size(), 1u);
  EXPECT_EQ(map.bodies[0].size(), 15u);
  EXPECT_THAT(map.left_out, IsEmpty());
  EXPECT_THAT(map.duplicates, IsEmpty());
  for (const auto& [id, side] : map.sides) {
    EXPECT_LT(std::abs(side.length_m - 0.1), 4 * side.sigma_m) << id;
    EXPECT_LT(side.sigma_m, 1e-3) << id;
  }
}

TEST(ClipMap, MarkersOfHalfTheLengthAreMeasured) {
  SyntheticScene scene = MakeSail();
  const std::set<int> small = {2, 6, 9, 13};
  Resize(0.5, small, &scene);
  const ClipMap map = MapOf(scene, Plain());
  ASSERT_EQ(map.bodies.size(), 1u);
  EXPECT_EQ(map.bodies[0].size(), 15u);
  for (const auto& [id, side] : map.sides) {
    const double truth_m = small.count(id) > 0 ? 0.05 : 0.1;
    EXPECT_LT(std::abs(side.length_m - truth_m), std::max(4 * side.sigma_m, 1e-4)) << id;
  }
}

TEST(ClipMap, IdsThatTheLayoutDoesNotNameCount) {
  SyntheticScene scene = MakeSail();
  for (FrameDetections& frame : scene.frames) {
    for (auto marker = frame.markers.begin(); marker != frame.markers.end(); ++marker) {
      if (marker->marker_id != 7) continue;
      frame.rejected.push_back({*marker, kNotInLayout});
      frame.markers.erase(marker);
      break;
    }
  }
  EXPECT_EQ(MapOf(scene, Plain()).bodies[0].count(7), 1u);
}

TEST(ClipMap, AnIdThatIsThereTwiceIsNamed) {
  SyntheticScene scene = MakeSail();
  for (FrameDetections& frame : scene.frames) {
    for (const MarkerDetection& marker : frame.markers) {
      if (marker.marker_id != 7) continue;
      MarkerDetection other = marker;
      for (Eigen::Vector2d& x_px : other.corners_in_image_px) x_px.x() += 300;
      frame.rejected.push_back({other, "another one is nearer to its neighbours"});
      break;
    }
  }
  EXPECT_THAT(MapOf(scene, Plain()).duplicates,
              testing::ElementsAre(HasSubstr("marker 7 occurs twice")));
}

// Lets the markers go their own way, with the given speed of rotation and in the given direction.
void Move(const std::vector<int>& ids, double rad_per_frame, const Eigen::Vector3d& step_m,
          SyntheticScene* scene) {
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    const auto time = static_cast<double>(i);
    const Rigid3 motion{Eigen::Quaterniond(Eigen::AngleAxisd(
                            rad_per_frame * time, Eigen::Vector3d(1, 1, 0).normalized())),
                        time * step_m + Eigen::Vector3d(0, 0, 0.01 * static_cast<double>(i % 5))};
    for (MarkerDetection& marker : scene->frames[i].markers) {
      if (std::count(ids.begin(), ids.end(), marker.marker_id) == 0) continue;
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        const Eigen::Vector3d x = scene->x_in_world.at(marker.marker_id)[c + 1];
        marker.corners_in_image_px[c] =
            *ImageFromCam(scene->camera, scene->cam_from_world[i] * (motion * x));
      }
    }
  }
}

TEST(ClipMap, WhatMovesAgainstTheRestIsABodyOfItsOwn) {
  // The markers of the last line go their own way, as a hull does below a sail.
  SyntheticScene scene = MakeSail();
  const std::vector<int>& last = scene.layout.parts[0].horizontal.back().marker_ids;
  Move(last, 0.03, {0.02, 0.0, 0.0}, &scene);
  const ClipMap map = MapOf(scene, Plain());
  ASSERT_EQ(map.bodies.size(), 2u);
  EXPECT_EQ(map.bodies[0].size(), 10u);
  std::vector<int> second;
  for (const auto& [id, points] : map.bodies[1]) second.push_back(id);
  EXPECT_EQ(second, last);
}

TEST(ClipMap, MarkersOfTooSmallABodyAreLeftOutWithAReason) {
  // Three markers of the last line go one way, and the other two another way.
  SyntheticScene scene = MakeSail();
  const std::vector<int>& last = scene.layout.parts[0].horizontal.back().marker_ids;
  Move({last[0], last[1], last[2]}, 0.03, {0.02, 0.0, 0.0}, &scene);
  Move({last[3], last[4]}, -0.03, {-0.02, 0.0, 0.0}, &scene);
  const ClipMap map = MapOf(scene, Plain());
  for (const auto& [id, points] : scene.x_in_world) {
    const bool is_on_body = std::any_of(map.bodies.begin(), map.bodies.end(),
                                        [id = id](auto& body) { return body.count(id) > 0; });
    EXPECT_NE(is_on_body, map.left_out.count(id) > 0) << id;
    EXPECT_TRUE(is_on_body || map.sides.count(id) == 0) << id;
  }
}

}  // namespace
}  // namespace velamap
