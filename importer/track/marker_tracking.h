// Tracks the markers of a video from frame to frame, so that only the places where they should be
// are searched. Between full searches a frame is searched in two passes:
//
//   1. around every marker of the last frame, shifted by its velocity;
//   2. around the markers that pass 1 missed and those lost earlier, shifted by the motion of the
//      found markers around them; and along the borders where the picture moves inwards.
//
// Both passes first try to locate the known marker, and where it is not seen clearly they search
// the region around it for any marker. Markers that are missing where the prior shape or the
// layout's lines expect them are located or searched in the same way.
//
// Halfway between two full searches a coarse search of the whole frame finds new large markers. The
// whole frame is searched if far fewer markers are found than usual or if the regions fill most of
// the picture, and then in each following frame as long as this finds new markers. The result
// depends only on the frames and their order.
//
// All tracks end after kFullSearchesPerGroup full searches. As with the key frames of an encoded
// video, no frame depends on a frame before that, so the import of a long video can be split there
// (importer/import_part.h).

#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/detect/marker_quad.h"
#include "importer/track/border_inflow.h"
#include "importer/track/marker_track.h"

namespace velamap {

// 1800 frames with a full search in every 15th. Small markers that only tracking finds are lost at
// the start of a group: 1 % of all markers if the markers are hardly large enough to be found.
inline constexpr int kFullSearchesPerGroup = 120;

// The state of the tracking after a frame.
struct MarkerTracks {
  std::vector<MarkerTrack> tracks;
  int frame_number = 0;  // of the last frame that was searched
  bool has_new = false;  // the last full search found new markers, so the next may find more
  // How far the picture has moved inwards at the left, top, right and bottom border since the band
  // along it was searched, px; negative: outwards.
  BorderInflow inflow_px{};
};

// The searches that a frame offers.
struct FrameSearch {
  cv::Size image_size;
  // All markers within the regions.
  std::function<std::vector<MarkerQuad>(const std::vector<cv::Rect>& regions)> search_regions;
  // The marker within `reach_px` of `expected`; nothing if in doubt.
  std::function<std::optional<QuadCorners>(int marker_id, const QuadCorners& expected,
                                           double reach_px)>
      locate;
  // The markers that a coarse search of the whole frame has found; empty without such a search.
  std::vector<MarkerQuad> seen_coarsely{};
  // The places of markers that are not among `found` but should be visible; may be empty.
  std::function<std::vector<ExpectedMarker>(const std::vector<MarkerQuad>& found)> expect{};
};

// Searches the next frame of `tracks`' video and brings `tracks` up to it.
std::vector<MarkerQuad> SearchTracked(const FrameSearch& search, int frame_number,
                                      MarkerTracks* tracks);

// The same for a frame whose `quads` come from a search of the whole frame: adds those markers that
// it missed and that can be located.
std::vector<MarkerQuad> CompleteFullSearch(const FrameSearch& search, std::vector<MarkerQuad> quads,
                                           int frame_number, MarkerTracks* tracks);

}  // namespace velamap
