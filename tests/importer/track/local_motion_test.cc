#include "importer/track/local_motion.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

TEST(LocalMotion, OneMarkerSaysHowItMovesItself) {
  EXPECT_EQ(LocalMotion({}, {5, 6}), Eigen::Vector2d(0, 0));
  EXPECT_EQ(LocalMotion({{{1, 2}, {4, 0}}}, {500, 600}), Eigen::Vector2d(3, -2));
}

TEST(LocalMotion, TurnAndScaleAreFollowedWhereMarkersStandFarApart) {
  const auto move = [](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(1.02 * p.x() - 0.03 * p.y() + 7, 0.03 * p.x() + 1.02 * p.y() - 4);
  };
  std::vector<PointMotion> motions;
  for (const Eigen::Vector2d& p :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(900, 100), Eigen::Vector2d(300, 800)}) {
    motions.push_back({p, move(p)});
  }
  const Eigen::Vector2d p(700, 700);
  EXPECT_LT((LocalMotion(motions, p) - (move(p) - p)).norm(), 0.5);
  EXPECT_GT((move(p) - p).norm(), 30.0);
}

TEST(LocalMotion, APixelOfNoiseOfCloseMarkersDoesNotGrowFarAway) {
  const std::vector<PointMotion> motions = {{{0, 0}, {0, 1}}, {{10, 0}, {10, -1}}};
  EXPECT_LT(LocalMotion(motions, {100, 0}).norm(), 1.0);
}

TEST(LocalMotion, FarMarkersOfAnotherBodyDoNotCount) {
  std::vector<PointMotion> motions;
  for (int i = 0; i < 5; ++i) motions.push_back({{100.0 * i, 0.0}, {100.0 * i + 3, 1.0}});
  for (int i = 0; i < 9; ++i) motions.push_back({{100.0 * i, 3000.0}, {100.0 * i - 9, 3000.0}});
  EXPECT_LT((LocalMotion(motions, {200, 50}) - Eigen::Vector2d(3, 1)).norm(), 1e-9);
}

}  // namespace
}  // namespace velamap
