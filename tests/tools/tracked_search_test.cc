// The tracked search against the exhaustive one on rendered clips with known truth.

#include <map>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "importer/detect/marker_location.h"
#include "importer/detect/marker_search.h"
#include "importer/refine/marker_detector.h"
#include "importer/track/marker_tracking.h"
#include "tests/support/render/surface_renderer.h"

namespace velamap {
namespace {

constexpr int kFullSearchInterval = 15;

// Corners of markers found by their pixels; those of a polygon are within 3 px.
bool IsCorrect(const ClipScene& scene, int frame_idx, const MarkerQuad& quad) {
  for (const ClipMarker& marker : scene.markers) {
    if (marker.marker_id != quad.marker_id) continue;
    const auto truth = ProjectCorners(scene, marker, frame_idx);
    if (!truth) return false;
    for (std::size_t c = 0; c < kNumCorners; ++c) {
      const Eigen::Vector2d in_image_px = quad.corners_px[c] + Eigen::Vector2d(0.5, 0.5);
      if ((in_image_px - (*truth)[c]).norm() > 3.0) return false;
    }
    return true;
  }
  return false;
}

struct Tally {
  int num_correct = 0;
  int num_false = 0;
  double area_px = 0.0;
};

struct Outcome {
  Tally exhaustive, tracked;
  int num_common = 0;  // correct in both
  int num_off = 0;     // of these, with refined corners more than 0.01 px apart
};

void Count(const ClipScene& scene, int frame_idx, const std::vector<MarkerQuad>& quads,
           Tally* tally) {
  for (const MarkerQuad& quad : quads) {
    ++(IsCorrect(scene, frame_idx, quad) ? tally->num_correct : tally->num_false);
  }
}

Outcome Compare(const ClipOptions& clip) {
  const ClipScene scene = MakeClipScene(clip);
  Outcome outcome;
  MarkerTracks tracks;
  for (int i = 0; i < clip.num_frames; ++i) {
    cv::Mat gray;
    cv::cvtColor(RenderClipFrame(scene, {}, i), gray, cv::COLOR_BGR2GRAY);
    const std::vector<MarkerQuad> all = SearchMarkers(gray, scene.dictionary, 1, {});
    outcome.exhaustive.area_px += gray.size().area();
    const auto search = [&](const std::vector<cv::Rect>& regions) {
      for (const cv::Rect& region : regions) outcome.tracked.area_px += region.area();
      return SearchMarkers(gray, scene.dictionary, 1, {}, regions);
    };
    const auto locate = [&](int id, const QuadCorners& expected, double reach_px) {
      return LocateMarker(gray, expected, {MarkerCells(scene.dictionary, id, 1)}, reach_px);
    };
    std::vector<MarkerQuad> found;
    if (i % kFullSearchInterval == 0) {
      found = CompleteFullSearch({gray.size(), search, locate},
                                 search({cv::Rect({0, 0}, gray.size())}), i, &tracks);
    } else {
      found = SearchTracked({gray.size(), search, locate}, i, &tracks);
    }
    Count(scene, i, all, &outcome.exhaustive);
    Count(scene, i, found, &outcome.tracked);
    std::map<int, MarkerDetection> refined;
    for (const MarkerDetection& marker : RefineMarkers(gray, all, scene.dictionary, 1, {})) {
      refined[marker.marker_id] = marker;
    }
    for (const MarkerDetection& marker : RefineMarkers(gray, found, scene.dictionary, 1, {})) {
      const auto same = refined.find(marker.marker_id);
      if (same == refined.end()) continue;
      ++outcome.num_common;
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        if ((marker.corners_in_image_px[c] - same->second.corners_in_image_px[c]).norm() > 0.01) {
          ++outcome.num_off;
          break;
        }
      }
    }
  }
  return outcome;
}

class TrackedSearchTest : public testing::TestWithParam<bool> {};

TEST_P(TrackedSearchTest, FindsWhatTheExhaustiveSearchFinds) {
  ClipOptions clip;
  clip.width_px = 1280;
  clip.num_frames = 24;
  clip.distance_m = 3.0;
  clip.sail_scale = 0.5;
  clip.busy = GetParam();
  const Outcome outcome = Compare(clip);
  RecordProperty("correct_exhaustive", outcome.exhaustive.num_correct);
  RecordProperty("correct_tracked", outcome.tracked.num_correct);
  RecordProperty("area", std::to_string(outcome.tracked.area_px / outcome.exhaustive.area_px));
  EXPECT_GT(outcome.exhaustive.num_correct, 400);
  EXPECT_GE(outcome.tracked.num_correct, 0.995 * outcome.exhaustive.num_correct);
  EXPECT_LE(outcome.tracked.num_false, outcome.exhaustive.num_false);
  EXPECT_LE(outcome.num_off, 0.005 * outcome.num_common);
  EXPECT_LT(outcome.tracked.area_px, 0.5 * outcome.exhaustive.area_px);
}

INSTANTIATE_TEST_SUITE_P(CalmAndBusy, TrackedSearchTest, testing::Bool());

}  // namespace
}  // namespace velamap
