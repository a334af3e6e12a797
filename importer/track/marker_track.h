// Tracks of markers: where a marker should be in the next frame, which detection continues which
// track, and the tracks after a frame.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/detect/marker_quad.h"
#include "importer/track/local_motion.h"

namespace velamap {

// Corners in OpenCV's pixel frame, px.
struct MarkerTrack {
  int marker_id = 0;
  QuadCorners corners_px;  // in the last frame: found there, or shifted with the markers around
  std::optional<Eigen::Vector2d> velocity_px{};  // per frame; if found in the last two searches
  int num_lost = 0;                              // frames since it was found
  int num_found = 1;                             // frames in which it was found
  double hit_rate = 0.5;                         // running mean of the frames in which it was found
};

// The expected place of a marker of the last frame in this one, and the radius of its search.
struct TrackPrediction {
  QuadCorners corners_px;
  double margin_px = 0.0;
};

// Predicts the place `num_frames` later by the velocity; a marker without one moves like those
// around it. `velocities` are those of all markers, each over one frame.
TrackPrediction PredictByVelocity(const MarkerTrack& track,
                                  const std::vector<PointMotion>& velocities, int num_frames);

// Predicts by the motion of the markers around it since the last frame.
TrackPrediction PredictByOthers(const MarkerTrack& track, const std::vector<PointMotion>& motions);

// Returns, for each track, the index of the quad with the same id that continues it, or -1. The
// nearest pairs are matched first.
std::vector<int> Associate(const std::vector<MarkerTrack>& tracks,
                           const std::vector<MarkerQuad>& quads, const cv::Size& image_size);

// How the markers of the last frame have moved since.
std::vector<PointMotion> MotionsOf(const std::vector<MarkerTrack>& tracks,
                                   const std::vector<MarkerQuad>& quads,
                                   const std::vector<int>& quad_of_track);

// The tracks after a frame with `quads`, which is `num_frames` later: continued ones, lost ones
// shifted with their surroundings, and new ones.
std::vector<MarkerTrack> UpdateTracks(const std::vector<MarkerTrack>& tracks,
                                      const std::vector<MarkerQuad>& quads,
                                      const cv::Size& image_size, int num_frames);

// The longest side of the boxes around the markers of the last frame, px.
double LargestMarker(const std::vector<MarkerTrack>& tracks);

}  // namespace velamap
