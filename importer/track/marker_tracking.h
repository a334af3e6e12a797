// Markers of a video from frame to frame: where those of the last frames should be now, so that
// only these places are looked at. Between full searches a frame is searched in two passes:
//
//   1. around every marker of the last frame, moved on by its velocity;
//   2. around those that pass 1 missed and those lost earlier, moved on as the found ones around
//      them have just moved; and along the borders, where the picture moves inwards.
//
// In both a marker is first looked for as what it is, and then, where it is not to be seen clearly,
// as any marker within the region around it.
//
// What is missing where the prior shape or the layout's lines say that it should be visible is
// looked for in the same two ways.
//
// Halfway between two full searches a coarse one of the whole frame tells of new large markers.
// Where far fewer are found than usual, or the places fill most of the picture, the whole frame is
// searched, and again the next one as long as this finds new markers. The result depends on
// the frames and their order only.

#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/detect/marker_quad.h"
#include "importer/track/border_inflow.h"

namespace velamap {

// Corners in OpenCV's pixel frame, px.
struct MarkerTrack {
  int marker_id = 0;
  QuadCorners corners_px;  // in the last frame: found there, or moved along with those around
  std::optional<Eigen::Vector2d> velocity_px{};  // a frame; of one found in the last two searches
  int num_lost = 0;                              // frames since it was found
  int num_found = 1;                             // frames in which it was found
  double hit_rate = 0.5;                         // part of the last frames in which it was found
};

// What one frame hands on to the next.
struct MarkerTracks {
  std::vector<MarkerTrack> tracks;
  int frame_number = 0;  // of the last frame that was searched
  bool has_new = false;  // the last full search found new markers, so the next may find more
  // How far the picture has come in at the left, top, right and bottom border since the band along
  // it was searched, px; negative: it went out.
  BorderInflow inflow_px{};
};

// What can be done with the picture of a frame.
struct FrameSearch {
  cv::Size image_size;
  // All markers within the regions.
  std::function<std::vector<MarkerQuad>(const std::vector<cv::Rect>& regions)> search_regions;
  // The marker within `reach_px` of `expected`; nothing if in doubt.
  std::function<std::optional<QuadCorners>(int marker_id, const QuadCorners& expected,
                                           double reach_px)>
      locate;
  // What a coarse search of the whole frame has found, where there was one.
  std::vector<MarkerQuad> seen_coarsely{};
  // Where markers that are not among `found` should be visible; may be empty.
  std::function<std::vector<ExpectedMarker>(const std::vector<MarkerQuad>& found)> expect{};
};

// Searches the next frame of `tracks`' video and brings `tracks` up to it.
std::vector<MarkerQuad> SearchTracked(const FrameSearch& search, int frame_number,
                                      MarkerTracks* tracks);

// The same for a frame of which `quads` are known by a search of the whole frame: with the markers
// that it missed, but that can be located.
std::vector<MarkerQuad> CompleteFullSearch(const FrameSearch& search, std::vector<MarkerQuad> quads,
                                           int frame_number, MarkerTracks* tracks);

}  // namespace velamap
