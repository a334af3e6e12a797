#include "importer/track/marker_tracking.h"

#include <algorithm>
#include <utility>

#include "importer/detect/marker_search.h"
#include "importer/detect/search_regions.h"
#include "importer/track/local_motion.h"

namespace velamap {
namespace {

// Larger parts of the picture than this are left to a full search, which finds more.
constexpr double kMaxSearchedPart = 0.6;

// Fewer than this part of the markers that are to be expected is a jerk or a cut. Small markers are
// found in some frames only, so each counts as often as it was found lately.
constexpr double kMinFoundPart = 0.5;
constexpr double kHitRateStep = 0.2;

// A lost marker is looked for so many frames for each in which it was found, up to a limit: a false
// one is soon forgotten.
constexpr int kLostFramesPerFound = 5;
constexpr int kMaxLostFrames = 90;

void Move(const Eigen::Vector2d& displacement, QuadCorners* corners) {
  for (Eigen::Vector2d& corner : *corners) corner += displacement;
}

// A marker of the last frame, where it should be in this one.
struct Prediction {
  QuadCorners corners_px;
  double margin_px = 0.0;
};

// Pass 1. Without a velocity of its own a marker moves as those around it did.
Prediction PredictByVelocity(const MarkerTrack& track, const std::vector<PointMotion>& velocities,
                             int num_frames) {
  const Eigen::Vector2d velocity = track.velocity_px
                                       ? *track.velocity_px
                                       : LocalMotion(velocities, QuadCenter(track.corners_px));
  Prediction prediction{track.corners_px, 0.0};
  Move(velocity * num_frames, &prediction.corners_px);
  prediction.margin_px = 6.0 + 0.2 * QuadMeanSide(track.corners_px) +
                         0.5 * std::min(velocity.norm() * num_frames, 40.0);
  return prediction;
}

// Pass 2.
Prediction PredictByOthers(const MarkerTrack& track, const std::vector<PointMotion>& motions) {
  Prediction prediction{track.corners_px, 0.0};
  Move(LocalMotion(motions, QuadCenter(track.corners_px)), &prediction.corners_px);
  prediction.margin_px = 6.0 + 0.4 * QuadMeanSide(track.corners_px) + std::min(track.num_lost, 20);
  return prediction;
}

// For each track the quad that continues it, or -1: of the same id, the nearest first.
std::vector<int> Associate(const std::vector<MarkerTrack>& tracks,
                           const std::vector<MarkerQuad>& quads, const cv::Size& image_size) {
  struct Pair {
    double distance_px;
    std::size_t track_idx, quad_idx;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (std::size_t q = 0; q < quads.size(); ++q) {
      if (tracks[t].marker_id != quads[q].marker_id) continue;
      const double distance_px =
          (QuadCenter(tracks[t].corners_px) - QuadCenter(quads[q].corners_px)).norm();
      const double limit_px = 2.0 * QuadMeanSide(tracks[t].corners_px) + 0.05 * image_size.width;
      if (distance_px < limit_px) pairs.push_back({distance_px, t, q});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.distance_px < b.distance_px; });
  std::vector<int> quad_of_track(tracks.size(), -1);
  std::vector<bool> taken(quads.size(), false);
  for (const Pair& pair : pairs) {
    if (taken[pair.quad_idx] || quad_of_track[pair.track_idx] >= 0) continue;
    quad_of_track[pair.track_idx] = static_cast<int>(pair.quad_idx);
    taken[pair.quad_idx] = true;
  }
  return quad_of_track;
}

// How the markers of the last frame have moved since.
std::vector<PointMotion> MotionsOf(const std::vector<MarkerTrack>& tracks,
                                   const std::vector<MarkerQuad>& quads,
                                   const std::vector<int>& quad_of_track) {
  std::vector<PointMotion> motions;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (quad_of_track[t] < 0 || tracks[t].num_lost > 0) continue;
    motions.push_back(
        {QuadCenter(tracks[t].corners_px), QuadCenter(quads[quad_of_track[t]].corners_px)});
  }
  return motions;
}

double LargestMarker(const std::vector<MarkerTrack>& tracks) {
  double largest_px = 0.0;
  for (const MarkerTrack& track : tracks) {
    const Box box = BoundingBox(track.corners_px);
    if (track.num_lost == 0) largest_px = std::max(largest_px, (box.max - box.min).maxCoeff());
  }
  return largest_px;
}

// The tracks after a frame with `quads`: those that go on, moved along where they are lost, and new
// ones.
std::vector<MarkerTrack> Continue(const std::vector<MarkerTrack>& tracks,
                                  const std::vector<MarkerQuad>& quads,
                                  const std::vector<int>& quad_of_track,
                                  const std::vector<PointMotion>& motions, const cv::Size& size,
                                  int num_frames) {
  std::vector<MarkerTrack> next;
  std::vector<bool> known(quads.size(), false);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    MarkerTrack track = tracks[t];
    if (quad_of_track[t] >= 0) {
      known[quad_of_track[t]] = true;
      const QuadCorners& corners = quads[quad_of_track[t]].corners_px;
      track.velocity_px.reset();
      if (track.num_lost == 0) {
        track.velocity_px = (QuadCenter(corners) - QuadCenter(track.corners_px)) / num_frames;
      }
      track.corners_px = corners;
      track.num_lost = 0;
      ++track.num_found;
      track.hit_rate += kHitRateStep * (1.0 - track.hit_rate);
    } else {
      track.hit_rate -= kHitRateStep * track.hit_rate;
      Move(LocalMotion(motions, QuadCenter(track.corners_px)), &track.corners_px);
      track.velocity_px.reset();
      track.num_lost += num_frames;
      const int patience = std::min(kMaxLostFrames, kLostFramesPerFound * track.num_found);
      const bool is_near = FitsIn(BoundingBox(track.corners_px), size, 0.25 * size.width);
      if (track.num_lost > patience || !is_near) continue;
    }
    next.push_back(track);
  }
  for (std::size_t q = 0; q < quads.size(); ++q) {
    if (!known[q]) next.push_back({quads[q].marker_id, quads[q].corners_px});
  }
  return next;
}

// Adds the marker if it is to be seen at its place; false if not.
bool AddLocated(const FrameSearch& search, int marker_id, const QuadCorners& expected,
                double reach_px, std::vector<MarkerQuad>* quads) {
  const auto located = search.locate(marker_id, expected, reach_px);
  if (located) quads->push_back({marker_id, *located});
  return located.has_value();
}

// Looks for a marker where it should be; if it is not to be seen clearly, adds the region to
// search.
void LookFor(const FrameSearch& search, int marker_id, const Prediction& prediction,
             std::vector<MarkerQuad>* quads, std::vector<cv::Rect>* regions) {
  const Box box = BoundingBox(prediction.corners_px);
  if (!FitsIn(box, search.image_size, prediction.margin_px)) return;
  if (!AddLocated(search, marker_id, prediction.corners_px, prediction.margin_px, quads)) {
    regions->push_back(RegionAround(box, search.image_size, prediction.margin_px));
  }
}

// Adds what is found in the regions. False if they fill most of the picture.
bool SearchAlso(const FrameSearch& search, std::vector<cv::Rect> regions,
                std::vector<MarkerQuad>* quads) {
  regions = MergeRegions(std::move(regions));
  if (AreaOf(regions) > kMaxSearchedPart * search.image_size.area()) return false;
  if (!regions.empty()) {
    const std::vector<MarkerQuad> found = search.search_regions(regions);
    quads->insert(quads->end(), found.begin(), found.end());
  }
  *quads = RemoveNested(std::move(*quads));
  return true;
}

// Looks for what is missing where it should be. Returns the regions where none is to be seen
// clearly.
std::vector<cv::Rect> LookWhereExpected(const FrameSearch& search, std::vector<MarkerQuad>* quads) {
  std::vector<cv::Rect> unclear;
  if (!search.expect) return unclear;
  for (const auto& [quad, reach_px] : search.expect(*quads)) {
    const Box box = BoundingBox(quad.corners_px);
    if (!FitsIn(box, search.image_size, reach_px)) continue;
    if (!AddLocated(search, quad.marker_id, quad.corners_px, reach_px, quads)) {
      unclear.push_back(RegionAround(box, search.image_size, reach_px));
    }
  }
  return unclear;
}

// What pass 1 found, and what it says of all others.
struct FirstPass {
  std::vector<MarkerQuad> quads;
  std::vector<int> quad_of_track;
  std::vector<PointMotion> motions;
};

// Nothing if the places fill most of the picture.
std::optional<FirstPass> SearchByVelocity(const FrameSearch& search, int num_frames,
                                          const std::vector<MarkerTrack>& tracks) {
  std::vector<PointMotion> velocities;
  for (const MarkerTrack& track : tracks) {
    const Eigen::Vector2d center = QuadCenter(track.corners_px);
    if (track.velocity_px) velocities.push_back({center, center + *track.velocity_px});
  }
  FirstPass pass;
  std::vector<cv::Rect> regions;
  for (const MarkerTrack& track : tracks) {
    if (track.num_lost > 0) continue;
    LookFor(search, track.marker_id, PredictByVelocity(track, velocities, num_frames), &pass.quads,
            &regions);
  }
  if (!SearchAlso(search, std::move(regions), &pass.quads)) return std::nullopt;
  pass.quad_of_track = Associate(tracks, pass.quads, search.image_size);
  pass.motions = MotionsOf(tracks, pass.quads, pass.quad_of_track);
  return pass;
}

// Whether fewer markers are found than their hit rates let expect.
bool IsLost(const std::vector<MarkerTrack>& tracks, const std::vector<int>& quad_of_track,
            const std::vector<PointMotion>& motions, const cv::Size& size) {
  double num_expected = 0.0, num_found = 0.0;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    const bool is_found = quad_of_track[t] >= 0;
    if (!is_found) {
      const Prediction prediction = PredictByOthers(tracks[t], motions);
      if (!FitsIn(BoundingBox(prediction.corners_px), size, -prediction.margin_px)) continue;
    }
    num_expected += tracks[t].hit_rate;
    num_found += is_found;
  }
  return num_found < kMinFoundPart * num_expected;
}

// Both passes; nothing where a search of the whole frame is called for.
std::optional<std::vector<MarkerQuad>> SearchPlaces(const FrameSearch& search, int num_frames,
                                                    MarkerTracks* tracks) {
  const cv::Size& size = search.image_size;
  const std::optional<FirstPass> first = SearchByVelocity(search, num_frames, tracks->tracks);
  if (!first || first->motions.empty()) return std::nullopt;
  BorderInflow inflow_px = AddInflow(first->motions, size, tracks->inflow_px);
  std::vector<cv::Rect> regions = BorderRegions(LargestMarker(tracks->tracks), size, &inflow_px);
  std::vector<MarkerQuad> quads = first->quads;
  quads.insert(quads.end(), search.seen_coarsely.begin(), search.seen_coarsely.end());
  for (std::size_t t = 0; t < tracks->tracks.size(); ++t) {
    if (first->quad_of_track[t] >= 0) continue;
    const MarkerTrack& track = tracks->tracks[t];
    LookFor(search, track.marker_id, PredictByOthers(track, first->motions), &quads, &regions);
  }
  if (!SearchAlso(search, std::move(regions), &quads)) return std::nullopt;
  const std::vector<int> quad_of_track = Associate(tracks->tracks, quads, size);
  if (IsLost(tracks->tracks, quad_of_track, first->motions, size)) return std::nullopt;
  if (!SearchAlso(search, LookWhereExpected(search, &quads), &quads)) return std::nullopt;
  tracks->inflow_px = inflow_px;
  return quads;
}

void HandOn(const std::vector<MarkerQuad>& quads, const cv::Size& size, int frame_number,
            MarkerTracks* tracks) {
  const std::vector<int> quad_of_track = Associate(tracks->tracks, quads, size);
  const std::vector<PointMotion> motions = MotionsOf(tracks->tracks, quads, quad_of_track);
  tracks->tracks = Continue(tracks->tracks, quads, quad_of_track, motions, size,
                            std::max(1, frame_number - tracks->frame_number));
  tracks->frame_number = frame_number;
}

}  // namespace

std::vector<MarkerQuad> SearchTracked(const FrameSearch& search, int frame_number,
                                      MarkerTracks* tracks) {
  const int num_frames = std::max(1, frame_number - tracks->frame_number);
  std::optional<std::vector<MarkerQuad>> quads;
  if (!tracks->has_new) quads = SearchPlaces(search, num_frames, tracks);
  if (quads) {
    HandOn(*quads, search.image_size, frame_number, tracks);
    return *std::move(quads);
  }
  return CompleteFullSearch(search, search.search_regions({cv::Rect({0, 0}, search.image_size)}),
                            frame_number, tracks);
}

std::vector<MarkerQuad> CompleteFullSearch(const FrameSearch& search, std::vector<MarkerQuad> quads,
                                           int frame_number, MarkerTracks* tracks) {
  const std::vector<int> quad_of_track = Associate(tracks->tracks, quads, search.image_size);
  const std::vector<PointMotion> motions = MotionsOf(tracks->tracks, quads, quad_of_track);
  const auto num_known = std::count_if(quad_of_track.begin(), quad_of_track.end(),
                                       [](int quad_idx) { return quad_idx >= 0; });
  const auto num_new = static_cast<std::ptrdiff_t>(quads.size()) - num_known;
  for (std::size_t t = 0; !motions.empty() && t < tracks->tracks.size(); ++t) {
    if (quad_of_track[t] >= 0) continue;
    const MarkerTrack& track = tracks->tracks[t];
    const Prediction prediction = PredictByOthers(track, motions);
    AddLocated(search, track.marker_id, prediction.corners_px, prediction.margin_px, &quads);
  }
  quads = RemoveNested(std::move(quads));
  LookWhereExpected(search, &quads);
  HandOn(quads, search.image_size, frame_number, tracks);
  tracks->has_new = num_new > 0;
  tracks->inflow_px = {};
  return quads;
}

}  // namespace velamap
