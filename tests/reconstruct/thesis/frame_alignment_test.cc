#include "reconstruct/thesis/frame_alignment.h"

#include <gtest/gtest.h>

#include "tests/reconstruct/registration_fixture.h"

namespace velamap {
namespace {

class FrameAlignmentTest : public testing::Test {
 protected:
  void SetUp() override {
    SyntheticSceneOptions options;
    options.num_frames = 5;
    scene_ = MakeSyntheticScene(options);
    frames_ = FrameShapes(scene_);
    for (const auto& [marker_id, points] : scene_.x_in_world) world_.emplace(marker_id, points);
  }

  void ExpectTruth(const FrameAlignment& alignment, int frame_idx) const {
    const Rigid3 truth = Inverse(scene_.cam_from_world[static_cast<std::size_t>(frame_idx)]);
    EXPECT_LT(AngularDistance(alignment.shape_from_cam, truth), 1e-7);
    EXPECT_LT((alignment.shape_from_cam.translation - truth.translation).norm(), 1e-8);
  }

  SyntheticScene scene_;
  std::vector<FrameShape> frames_;
  ShapePoints world_;
};

TEST_F(FrameAlignmentTest, NoiseFreeFrameIsPlacedExactly) {
  const auto alignment = AlignFrame(frames_[1], world_, scene_.layout, {});
  ASSERT_TRUE(alignment);
  ExpectTruth(*alignment, 1);
  EXPECT_TRUE(alignment->outlier_ids.empty());
  EXPECT_EQ(alignment->inlier_ids.size(), frames_[1].markers.size());
}

TEST_F(FrameAlignmentTest, ThirtyPercentWrongMarkersAreNamed) {
  ASSERT_GE(frames_[2].markers.size(), 20u);
  std::vector<int> moved;
  for (std::size_t i = 0; i < frames_[2].markers.size(); i += 3) {
    for (auto& solution : frames_[2].markers[i].x_in_cam) {
      for (auto& x : solution) x += Eigen::Vector3d(0.3, 0.1 * static_cast<double>(i), 0.2);
    }
    moved.push_back(frames_[2].markers[i].marker_id);
  }
  const auto alignment = AlignFrame(frames_[2], world_, scene_.layout, {});
  ASSERT_TRUE(alignment);
  ExpectTruth(*alignment, 2);
  EXPECT_EQ(alignment->outlier_ids, moved);
}

TEST_F(FrameAlignmentTest, TwoMarkersSufficeThroughTheirCorners) {
  frames_[1].markers.resize(2);
  const auto alignment = AlignFrame(frames_[1], world_, scene_.layout, {});
  ASSERT_TRUE(alignment);
  ExpectTruth(*alignment, 1);
}

TEST_F(FrameAlignmentTest, MarkersOnOneLineSufficeThroughTheirCorners) {
  SyntheticSceneOptions options;
  options.kind = SceneKind::kPlane;
  options.num_rows = 1;
  options.num_columns = 6;
  options.num_frames = 3;
  const SyntheticScene line = MakeSyntheticScene(options);
  const auto frames = FrameShapes(line);
  const auto alignment = AlignFrame(
      frames[1], ShapePoints(line.x_in_world.begin(), line.x_in_world.end()), line.layout, {});
  ASSERT_TRUE(alignment);
  EXPECT_LT(AngularDistance(alignment->shape_from_cam, Inverse(line.cam_from_world[1])), 1e-6);
}

TEST_F(FrameAlignmentTest, OneSharedMarkerIsNotEnough) {
  frames_[1].markers.resize(1);
  EXPECT_FALSE(AlignFrame(frames_[1], world_, scene_.layout, {}));
}

TEST_F(FrameAlignmentTest, WrongMarkersWithoutConsensusGiveNothing) {
  for (std::size_t i = 0; i < frames_[1].markers.size(); ++i) {
    for (auto& solution : frames_[1].markers[i].x_in_cam) {
      for (auto& x : solution) {
        x += 0.7 * static_cast<double>(i * i % 17) *
             Eigen::Vector3d(1, -0.5, static_cast<double>(i % 5));
      }
    }
  }
  RegistrationOptions options;
  options.min_num_inliers = 8;
  EXPECT_FALSE(AlignFrame(frames_[1], world_, scene_.layout, options));
}

}  // namespace
}  // namespace velamap
