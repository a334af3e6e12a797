#include "reconstruct/model/moved_views.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace velamap {
namespace {

constexpr double kSide_px = 20.0;
constexpr double kNoise_px = 0.1;
constexpr double kTolerance_px = 1.0;

// Views of a marker whose corner `corner` (0 to 3) is at `error_px(view, corner)`, plus noise.
template <typename Error>
std::vector<TrackedView> Views(int num_views, const Error& error_px) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise_px(0.0, kNoise_px);
  std::vector<TrackedView> views(static_cast<std::size_t>(num_views));
  for (int i = 0; i < num_views; ++i) {
    TrackedView& view = views[static_cast<std::size_t>(i)];
    view.side_px = kSide_px;
    for (std::size_t corner = 0; corner < kNumCorners; ++corner) {
      view.errors_px[corner] =
          error_px(i, corner) + Eigen::Vector2d(noise_px(random), noise_px(random));
      view.is_outlier = view.is_outlier || view.errors_px[corner].norm() > kTolerance_px;
    }
  }
  return views;
}

int NumMoved(const std::vector<TrackedView>& views) {
  const std::vector<bool> is_moved = FindMovedViews(views);
  return static_cast<int>(std::count(is_moved.begin(), is_moved.end(), true));
}

int NumOutliers(const std::vector<TrackedView>& views) {
  return static_cast<int>(std::count_if(views.begin(), views.end(),
                                        [](const TrackedView& view) { return view.is_outlier; }));
}

// The corners of a marker on a wave do not move alike.
TEST(FindMovedViews, AMarkerOnAFlappingSailHardlyHasOutliers) {
  for (const double period : {6.0, 12.7, 40.0}) {
    const auto views = Views(80, [&](int i, std::size_t corner) {
      const double phase = 2 * M_PI * i / period + 0.3 * static_cast<double>(corner % 2);
      return Eigen::Vector2d(7 * std::sin(phase), 2 * std::sin(phase));
    });
    EXPECT_GT(NumOutliers(views), 60);
    EXPECT_GE(NumMoved(views), (period < 10 ? 0.6 : 0.8) * NumOutliers(views)) << period;
  }
}

TEST(FindMovedViews, WhatCoversSomeCornersIsNoMotion) {
  const auto views = Views(80, [](int i, std::size_t corner) {
    return i % 20 < 8 && corner < 2 ? Eigen::Vector2d(4, 1) : Eigen::Vector2d(0, 0);
  });
  EXPECT_EQ(NumOutliers(views), 32);
  EXPECT_EQ(NumMoved(views), 0);
}

TEST(FindMovedViews, AnotherMarkerWithTheSameIdIsNoMotion) {
  const auto views = Views(80, [](int i, std::size_t) {
    return i < 30 ? Eigen::Vector2d(1.2 * kSide_px, 0) : Eigen::Vector2d(0, 0);
  });
  EXPECT_EQ(NumMoved(views), 0);
}

TEST(FindMovedViews, SingleWrongViewsAreNoMotion) {
  const auto views = Views(80, [](int i, std::size_t) -> Eigen::Vector2d {
    if (i % 3 != 0) return {0, 0};
    return {5 * std::cos(i), 5 * std::sin(i)};
  });
  EXPECT_EQ(NumOutliers(views), 27);
  EXPECT_EQ(NumMoved(views), 0);
}

TEST(FindMovedViews, AFewViewsDoNotCount) {
  const auto views = Views(80, [](int i, std::size_t) {
    return i == 40 || i == 41 ? Eigen::Vector2d(5, 0) : Eigen::Vector2d(0, 0);
  });
  EXPECT_EQ(NumOutliers(views), 2);
  EXPECT_EQ(NumMoved(views), 0);
  EXPECT_TRUE(FindMovedViews({}).empty());
}

}  // namespace
}  // namespace velamap
