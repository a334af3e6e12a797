// A registration whose map has grown, as cleanup finds it.

#pragma once

#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "reconstruct/global/map_cleanup.h"
#include "tests/reconstruct/map/scene_map.h"

namespace velamap {

// The true map of a scene as the state that cleanup works on. The state refers to the options and
// to the map, so they live together.
struct GrownMap {
  RegistrationOptions options;
  SceneMap map;
  GlobalRegistration global{options, {}, {}, false, -1, {}, {}, {}, {}, {}, {}};

  explicit GrownMap(SyntheticScene scene) : map(std::move(scene)) {
    for (const DatabaseImage& image : map.images) global.images.push_back(&image);
    global.image_idx_of_frame.resize(map.images.size());
    std::iota(global.image_idx_of_frame.begin(), global.image_idx_of_frame.end(), 0);
    global.left_out_of_image.resize(map.images.size());
    global.problem = map.problem;
    global.solution = map.TrueSolution();
    Update();
  }
  GrownMap(const GrownMap&) = delete;

  // Inliers and noise of the solution as it stands.
  void Update() {
    MarkInliers(global.problem, 1.0, &global.solution);
    global.noise = EstimateNoise(global.problem, global.solution);
  }

  std::vector<int> DroppedIds() const {
    std::vector<int> ids;
    for (const auto& [marker_idx, dropped] : global.dropped_markers) {
      EXPECT_EQ(dropped.marker_id, global.problem.Marker(marker_idx).marker_id);
      EXPECT_FALSE(dropped.reason.empty());
      EXPECT_TRUE(global.solution.Places(marker_idx).empty());
      EXPECT_EQ(global.NumInliers(marker_idx), 0);
      ids.push_back(dropped.marker_id);
    }
    return ids;
  }

  std::vector<int> LeftOutFrames() const {
    std::vector<int> frame_idxs;
    for (std::size_t idx = 0; idx < global.problem.frames.size(); ++idx) {
      const bool is_registered = global.solution.cam_from_shape[idx].has_value();
      EXPECT_EQ(global.left_out_of_image[idx].reason.empty(), is_registered) << idx;
      if (is_registered) continue;
      EXPECT_EQ(global.NumInliersInFrame(static_cast<int>(idx)), 0);
      frame_idxs.push_back(static_cast<int>(idx));
    }
    return frame_idxs;
  }
};

inline SyntheticScene SailWithNoise(int num_frames, bool video, std::uint32_t seed) {
  SyntheticScene scene = MakeScene(SceneKind::kSail, num_frames, video);
  AddNoise({0.2, 0.0, 0.0, 0, seed}, &scene);
  return scene;
}

}  // namespace velamap
