#include "importer/geometry/consensus_pose.h"

#include <gtest/gtest.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

Rigid3 TruePose(double distance_m) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(kPi - 0.3, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ())),
          {0.1, -0.2, distance_m}};
}

// `size` by `size` squares of 100 mm, 300 mm apart, on a bent sheet, as the camera sees them.
std::vector<MarkerRays> SeenSheet(int size, const Rigid3& cam_from_space) {
  std::vector<MarkerRays> markers;
  for (int i = 0; i < size * size; ++i) {
    const double x = 0.3 * (i % size), y = 0.3 * (i / size), h = 0.05;
    MarkerRays marker;
    const std::array<Eigen::Vector2d, kNumCorners> corners = {
        Eigen::Vector2d(x - h, y + h), Eigen::Vector2d(x + h, y + h), Eigen::Vector2d(x + h, y - h),
        Eigen::Vector2d(x - h, y - h)};
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      marker.corners_in_space[c] << corners[c], 0.1 * corners[c].x() * corners[c].x();
      marker.rays[c] = (cam_from_space * marker.corners_in_space[c]).hnormalized();
    }
    markers.push_back(marker);
  }
  return markers;
}

// Largest distance between where the two poses see a corner, as a part of a marker's side.
double MaxError(const std::vector<MarkerRays>& markers, const PoseHypothesis& pose) {
  double max_error = 0.0;
  for (const MarkerRays& marker : markers) {
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      const Eigen::Vector2d ray = (pose.cam_from_space * marker.corners_in_space[c]).hnormalized();
      max_error = std::max(max_error, (ray - marker.rays[c]).norm() / QuadMeanSide(marker.rays));
    }
  }
  return max_error;
}

TEST(FindConsensusPose, NoiseFreeCornersGiveTheTruePose) {
  const std::vector<MarkerRays> markers = SeenSheet(5, TruePose(4.0));
  const auto pose = FindConsensusPose(markers);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->inlier_idxs.size(), 25u);
  EXPECT_LT(MaxError(markers, *pose), 1e-9);
  EXPECT_LT(AngularDistance(pose->cam_from_space, TruePose(4.0)), 1e-9);
  EXPECT_LT((pose->cam_from_space.translation - TruePose(4.0).translation).norm(), 1e-9);
}

// A lens of 200 mm and a few markers: all rays within a hundredth of a radian.
TEST(FindConsensusPose, NarrowView) {
  for (const double distance_m : {60.0, 600.0}) {
    const std::vector<MarkerRays> markers = SeenSheet(2, TruePose(distance_m));
    const auto pose = FindConsensusPose(markers);
    ASSERT_TRUE(pose) << distance_m;
    EXPECT_LT(MaxError(markers, *pose), 1e-3) << distance_m;
  }
}

TEST(FindConsensusPose, FrameAndUnitOfTheSpaceDoNotMatter) {
  const std::vector<MarkerRays> markers = SeenSheet(4, TruePose(4.0));
  for (const double unit : {1e-6, 1e6}) {
    std::vector<MarkerRays> moved = markers;
    for (MarkerRays& marker : moved) {
      for (Eigen::Vector3d& x : marker.corners_in_space) {
        x = unit * (x + Eigen::Vector3d(5e5, -4e6, 30));
      }
    }
    const auto pose = FindConsensusPose(moved);
    ASSERT_TRUE(pose) << unit;
    EXPECT_LT(MaxError(moved, *pose), 1e-6) << unit;
  }
}

TEST(FindConsensusPose, HalfMayBeWrongAndALargeOneHasNoSay) {
  std::vector<MarkerRays> markers = SeenSheet(4, TruePose(4.0));
  for (std::size_t i = 0; i < 8; ++i) {
    for (Eigen::Vector2d& ray : markers[i].rays) ray.x() += 0.1 + 0.05 * static_cast<double>(i);
  }
  auto pose = FindConsensusPose(markers);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->inlier_idxs, (std::vector<int>{8, 9, 10, 11, 12, 13, 14, 15}));

  markers.resize(9);  // one is right
  markers[0].rays = {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, -1), Eigen::Vector2d(1, 1),
                     Eigen::Vector2d(-1, 1)};  // and one fills the picture
  EXPECT_FALSE(FindConsensusPose(markers));
}

TEST(FindConsensusPose, FewMarkersAndCornersWithoutExtentSayNothing) {
  std::vector<MarkerRays> markers = SeenSheet(2, TruePose(4.0));
  for (MarkerRays& marker : markers) marker.corners_in_space.fill({1, 2, 3});
  EXPECT_FALSE(FindConsensusPose(markers));
  markers = SeenSheet(2, TruePose(4.0));
  markers.pop_back();
  EXPECT_FALSE(FindConsensusPose(markers));
  EXPECT_FALSE(FindConsensusPose({}));
}

}  // namespace
}  // namespace velamap
