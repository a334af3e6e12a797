#include "importer/track/marker_track.h"

#include <algorithm>

#include "importer/detect/search_regions.h"

namespace velamap {
namespace {

constexpr double kHitRateStep = 0.2;

// A lost marker is searched for this many frames for each in which it was found, up to a limit, so
// that a false one is soon forgotten.
constexpr int kLostFramesPerFound = 5;
constexpr int kMaxLostFrames = 90;

void Shift(const Eigen::Vector2d& displacement, QuadCorners* corners) {
  for (Eigen::Vector2d& corner : *corners) corner += displacement;
}

}  // namespace

TrackPrediction PredictByVelocity(const MarkerTrack& track,
                                  const std::vector<PointMotion>& velocities, int num_frames) {
  const Eigen::Vector2d velocity = track.velocity_px
                                       ? *track.velocity_px
                                       : LocalMotion(velocities, QuadCenter(track.corners_px));
  TrackPrediction prediction{track.corners_px, 0.0};
  Shift(velocity * num_frames, &prediction.corners_px);
  prediction.margin_px = 6.0 + 0.2 * QuadMeanSide(track.corners_px) +
                         0.5 * std::min(velocity.norm() * num_frames, 40.0);
  return prediction;
}

TrackPrediction PredictByOthers(const MarkerTrack& track, const std::vector<PointMotion>& motions) {
  TrackPrediction prediction{track.corners_px, 0.0};
  Shift(LocalMotion(motions, QuadCenter(track.corners_px)), &prediction.corners_px);
  prediction.margin_px = 6.0 + 0.4 * QuadMeanSide(track.corners_px) + std::min(track.num_lost, 20);
  return prediction;
}

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

std::vector<MarkerTrack> UpdateTracks(const std::vector<MarkerTrack>& tracks,
                                      const std::vector<MarkerQuad>& quads,
                                      const cv::Size& image_size, int num_frames) {
  const std::vector<int> quad_of_track = Associate(tracks, quads, image_size);
  const std::vector<PointMotion> motions = MotionsOf(tracks, quads, quad_of_track);
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
      Shift(LocalMotion(motions, QuadCenter(track.corners_px)), &track.corners_px);
      track.velocity_px.reset();
      track.num_lost += num_frames;
      const int patience = std::min(kMaxLostFrames, kLostFramesPerFound * track.num_found);
      const bool is_near =
          FitsIn(BoundingBox(track.corners_px), image_size, 0.25 * image_size.width);
      if (track.num_lost > patience || !is_near) continue;
    }
    next.push_back(track);
  }
  for (std::size_t q = 0; q < quads.size(); ++q) {
    if (!known[q]) next.push_back({quads[q].marker_id, quads[q].corners_px});
  }
  return next;
}

}  // namespace velamap
