#include "importer/track/marker_tracking.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "importer/detect/marker_search.h"
#include "importer/track/line_expectation.h"

namespace velamap {
namespace {

const cv::Size kFrameSize(1920, 1080);

// A world of square markers that shows those that lie in the searched regions, and counts. They can
// also be located, if it is told so.
class FakeVideo {
 public:
  std::vector<MarkerQuad> Search(const std::vector<cv::Rect>& regions) {
    std::vector<MarkerQuad> found;
    for (const cv::Rect& region : regions) {
      num_full += region.size() == kFrameSize;
      area_px += region.area();
      EXPECT_EQ(region & cv::Rect({0, 0}, kFrameSize), region);
      for (const auto& [id, center] : markers) {
        const auto quad = Show(id, center, region);
        if (quad) found.push_back({id, *quad});
      }
    }
    return RemoveNested(found);
  }

  std::optional<QuadCorners> Locate(int marker_id, const QuadCorners& expected, double reach_px) {
    if (!can_locate) return std::nullopt;
    for (const auto& [id, center] : markers) {
      const auto quad = Show(id, center, {{0, 0}, kFrameSize});
      if (id != marker_id || !quad) continue;
      if ((QuadCenter(*quad) - QuadCenter(expected)).norm() > reach_px) continue;
      ++num_located;
      return quad;
    }
    return std::nullopt;
  }

  // The ids found in the next frame, ascending.
  std::vector<int> Next() {
    std::vector<int> ids;
    for (const MarkerQuad& quad : SearchTracked(
             {kFrameSize,
              [this](const auto&regions) { return Search(regions); },
              [this](int id, const QuadCorners&expected, double reach_px) {
                return Locate(id, expected, reach_px);
              },
              {},
              [this](const std::vector<MarkerQuad>&found) { return ExpectOnLines(lines, found); }},
             frame_number++, &tracks)) {
      ids.push_back(quad.marker_id);
    }
    std::sort(ids.begin(), ids.end());
    return ids;
  }

  // The marker, if the region holds it.
  std::optional<QuadCorners> Show(int id, const Eigen::Vector2d& center,
                                  const cv::Rect& region) const {
    if (std::count(hidden.begin(), hidden.end(), id) > 0) return std::nullopt;
    const Eigen::Vector2d at = center + offset_px;
    if (at.x() - kHalf < region.x || at.y() - kHalf < region.y || at.x() + kHalf >= region.br().x ||
        at.y() + kHalf >= region.br().y) {
      return std::nullopt;
    }
    return QuadCorners{at + Eigen::Vector2d(-kHalf, -kHalf), at + Eigen::Vector2d(kHalf, -kHalf),
                       at + Eigen::Vector2d(kHalf, kHalf), at + Eigen::Vector2d(-kHalf, kHalf)};
  }

  static constexpr double kHalf = 20.0;
  bool can_locate = false;
  std::vector<std::vector<int>> lines;
  std::vector<std::pair<int, Eigen::Vector2d>> markers;
  std::vector<int> hidden;
  Eigen::Vector2d offset_px{0, 0};
  int frame_number = 0;
  int num_full = 0;
  int num_located = 0;
  double area_px = 0.0;
  MarkerTracks tracks;
};

FakeVideo GridVideo() {
  FakeVideo video;
  for (int i = 0; i < 12; ++i) {
    video.markers.push_back({i, {300.0 + 300.0 * (i % 4), 250.0 + 250.0 * (i / 4)}});
  }
  return video;
}

TEST(SearchTracked, AcceleratedMarkersAreFollowedInASmallPartOfThePicture) {
  FakeVideo video = GridVideo();
  EXPECT_EQ(video.Next().size(), 12u);
  EXPECT_EQ(video.num_full, 1);  // and the next, as all are new
  video.area_px = 0;
  for (int i = 1; i < 20; ++i) {
    video.offset_px += Eigen::Vector2d(0.8 * i, -0.5 * i);  // up to 16 px a frame
    EXPECT_EQ(video.Next().size(), 12u) << i;
  }
  EXPECT_EQ(video.num_full, 2);
  EXPECT_LT(video.area_px, 0.25 * 19 * kFrameSize.area());
}

TEST(SearchTracked, MarkersThatCanBeLocatedNeedNoRegion) {
  FakeVideo video = GridVideo();
  for (int i = 0; i < 2; ++i) video.Next();
  video.can_locate = true;
  video.area_px = 0;
  for (int i = 1; i < 10; ++i) {
    video.offset_px += Eigen::Vector2d(0.8 * i, 0.0);
    EXPECT_EQ(video.Next().size(), 12u) << i;
  }
  EXPECT_EQ(video.num_located, 9 * 12);
  EXPECT_LT(video.area_px, 0.5 * kFrameSize.area());  // along the border where the picture comes in
}

TEST(SearchTracked, WhatIsMissingOnALineIsLocated) {
  FakeVideo video = GridVideo();
  video.hidden = {1};  // between 0 and 2
  for (int i = 0; i < 3; ++i) EXPECT_EQ(video.Next().size(), 11u);
  video.lines = {{0, 1, 2, 3}};
  video.hidden.clear();
  video.can_locate = true;
  EXPECT_EQ(video.Next().size(), 12u);
}

TEST(SearchTracked, WhatIsUnclearOnALineIsSearchedThere) {
  FakeVideo video = GridVideo();
  video.hidden = {1};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(video.Next().size(), 11u);
  video.hidden.clear();
  FakeVideo without_lines = video;
  video.lines = {{0, 1, 2, 3}};
  EXPECT_EQ(video.Next().size(), 12u);
  EXPECT_EQ(video.num_full, 2);
  EXPECT_EQ(without_lines.Next().size(), 11u);
}

TEST(SearchTracked, AJumpIsMetByAFullSearch) {
  FakeVideo video = GridVideo();
  for (int i = 0; i < 3; ++i) video.Next();
  video.offset_px = {240, 120};
  EXPECT_EQ(video.Next().size(), 12u);
  EXPECT_EQ(video.num_full, 3);
  EXPECT_EQ(video.Next().size(), 12u);
}

TEST(SearchTracked, AHiddenMarkerIsFoundAgainWhereThoseAroundItHaveGone) {
  FakeVideo video = GridVideo();
  for (int i = 0; i < 5; ++i) video.Next();
  video.hidden = {5};
  for (int i = 0; i < 12; ++i) {
    video.offset_px += Eigen::Vector2d(9, -4);
    EXPECT_EQ(video.Next().size(), 11u);
  }
  video.hidden.clear();
  video.offset_px += Eigen::Vector2d(9, -4);
  EXPECT_EQ(video.Next().size(), 12u);
  EXPECT_EQ(video.num_full, 2);
}

TEST(SearchTracked, NewMarkersComeInAtEveryBorder) {
  for (const auto& [side, step] :
       std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>{{{-200, 540}, {10, 0}},
                                                                {{2120, 540}, {-10, 0}},
                                                                {{960, -200}, {0, 10}},
                                                                {{960, 1280}, {0, -10}}}) {
    FakeVideo video = GridVideo();
    video.markers.push_back({40, side});
    int num_late = 0;
    for (int i = 0; i < 30; ++i) {
      video.offset_px = i * step;
      const std::vector<int> found = video.Next();
      const Eigen::Vector2d at = side + video.offset_px;
      const bool visible = at.x() >= 20 && at.y() >= 20 && at.x() < 1900 && at.y() < 1060;
      num_late += visible && found.back() != 40;
    }
    EXPECT_LE(num_late, 1) << side.transpose();
    EXPECT_EQ(video.num_full, 2) << side.transpose();
    EXPECT_EQ(video.Next().back(), 40);
  }
}

TEST(SearchTracked, WithoutMarkersEveryFrameIsSearchedAsAWhole) {
  FakeVideo video;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(video.Next().empty());
  EXPECT_EQ(video.num_full, 4);
  video.markers = {{1, {500, 500}}};
  EXPECT_EQ(video.Next(), std::vector<int>{1});
}

TEST(SearchTracked, AFalseMarkerIsSoonForgotten) {
  FakeVideo video = GridVideo();
  video.markers.push_back({77, {960, 900}});
  video.Next();
  video.hidden = {77};
  for (int i = 0; i < 10; ++i) video.Next();
  EXPECT_EQ(video.tracks.tracks.size(), 12u);
}

}  // namespace
}  // namespace velamap
