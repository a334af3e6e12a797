// A scene whose markers are printed at other sizes than the layout says.

#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "importer/geometry/alignment.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {

class PrintedSceneTest : public testing::Test {
 protected:
  // Adds noise of 0.05 px and adjusts the model.
  MarkerAdjustmentSummary Adjust(std::uint32_t seed = 1) {
    SyntheticScene noisy = scene_;
    AddNoise({0.05, 0, 0, 200, seed}, &noisy);
    model_ = MakeSceneModel(noisy);
    return AdjustWithMarkers(options_, noisy.layout, {}, &model_);
  }

  // Of the adjusted model, as a fraction.
  double ScaleError() const {
    std::vector<Eigen::Vector3d> x_in_world, x_in_truth;
    for (const auto& [point3D_id, point] : model_.points3D) {
      const CornerId id = CornerFromPoint3DId(point3D_id);
      x_in_world.push_back(point.x_in_world);
      x_in_truth.push_back(scene_.x_in_world.at(id.marker_id)[id.corner]);
    }
    return EstimateSim3(x_in_truth, x_in_world).scale - 1.0;
  }

  MarkerAdjustmentOptions options_;
  SyntheticScene scene_;
  Model model_;
};

}  // namespace velamap
