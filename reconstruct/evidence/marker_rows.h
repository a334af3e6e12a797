// Finds the lines of the markers from their positions alone, for objects without a layout.
//
// 1. Links. Two markers that face the same way are linked if no third marker is nearer to both of
//    them than they are to each other (relative neighbourhood graph; Toussaint, "The relative
//    neighbourhood graph of a finite planar set", Pattern Recognition 12(4), 1980), and if they are
//    about as far apart as one of them is from its nearest neighbour.
// 2. Rows. At each marker, links that continue each other are joined, the straightest pair first. A
//    row continues across a gap of up to two missing markers.
// 3. Groups. Rows that share a marker belong together, and so do nearby parallel horizontal rows
//    with similar steps.
//
// All tests use only angles and ratios of distances, so the scale of the shape may be arbitrary.

#pragma once

#include <vector>

#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

// Markers that belong together. Left, right and up are as seen by a viewer of the upright markers.
struct RowGroup {
  std::vector<std::vector<int>> horizontal;  // from the lowest; each from left to right
  std::vector<std::vector<int>> vertical;    // from the leftmost; each from the lowest up
  std::vector<int> others;                   // on none of these rows; ascending
  // Whether the markers agree on what is up. If not, the longest row is taken to be horizontal, and
  // either end of it may be the left one.
  bool knows_up = true;
  // Whether some rows share no marker with the others and were joined only because they are
  // parallel and have similar steps.
  bool is_joined_by_likeness = false;
  // How slanted the left and the right edge of the horizontal rows are: the absolute cosine of the
  // angle between the rows and the line through the ends of the lowest and the highest row. 0 for
  // fewer than two rows.
  double left_slant = 0.0, right_slant = 0.0;

  std::vector<int> MarkerIds() const;  // of all rows and the others, ascending, each once
};

// `shape` has at least one marker. Each marker is in one group. The largest group comes first.
std::vector<RowGroup> FindMarkerRows(const ShapePoints& shape);

}  // namespace velamap
