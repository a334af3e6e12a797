// Finds the lines on which markers stand from their places alone, where nobody has written them
// down.
//
// 1. Links. Two markers that face the same way are linked if no third marker is nearer to both of
//    them than they are to each other (relative neighbourhood graph; Toussaint, "The relative
//    neighbourhood graph of a finite planar set", Pattern Recognition 12(4), 1980), and if they are
//    about as far apart as other neighbours there.
// 2. Rows. At each marker, the links that continue each other are joined, the straightest first. A
//    row continues across a gap of up to two missing markers.
// 3. Groups. Rows that share a marker belong together, and so do parallel rows with equal steps.
//
// All tests depend on ratios of distances and on angles only.

#pragma once

#include <vector>

#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

// Markers that stand together. Left, right and up are those of the upright markers as they are
// looked at.
struct RowGroup {
  std::vector<std::vector<int>> horizontal;  // from the lowest; each from left to right
  std::vector<std::vector<int>> vertical;    // from the leftmost; each from the lowest up
  std::vector<int> others;                   // on none of these; ascending
  // The markers agree on what is up. Otherwise the longest row is taken to be horizontal, and
  // either end of it may be the left one.
  bool knows_up = true;
  // Some rows share no marker with the others, and only their likeness joins them.
  bool is_joined_by_likeness = false;
  // How far the left and the right ends of the horizontal rows are from standing above each other:
  // absolute cosine of the angle between their line and the rows. 0 for fewer than two rows.
  double left_slant = 0.0, right_slant = 0.0;

  int NumMarkers() const;  // each counts once
};

// `shape` has at least one marker. Each marker is in one group; the largest group comes first.
std::vector<RowGroup> FindMarkerRows(const ShapePoints& shape);

}  // namespace velamap
