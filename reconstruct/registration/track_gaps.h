// Fills the gaps in the tracks of markers that single frames of a video do not show.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/detect/detection.h"

namespace velamap {

// Means of the corners in the image, px, by marker id.
using MarkerPlaces = std::map<int, Eigen::Vector2d>;

struct TimedPlaces {
  double time_s = 0.0;
  double side_px = 0.0;  // mean side of the markers
  // Whether the next frame follows so soon that one path of a marker passes through both.
  bool is_near_next = false;
  MarkerPlaces places;
};

// Those of a frame with a time.
TimedPlaces PlacesOf(const FrameDetections& frame);

// Adds the places of markers that frames lack between two frames that show them. From the first of
// the two, a marker moves as the field (motion_field.h) of the markers that two consecutive frames
// show; the distance by which it misses its place in the second is distributed over the time
// between. Without the added places, a marker that misses a frame would follow a shake of the
// camera less than the others do. Gaps with fewer than three other markers, or across frames that
// are not near each other, stay. `frames` are in the order of time.
void FillGaps(std::vector<TimedPlaces>* frames);

}  // namespace velamap
