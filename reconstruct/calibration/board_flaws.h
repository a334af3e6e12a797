// How a printed board differs from a flat one with squares of equal size.

#pragma once

#include "reconstruct/geometry/point_covariance.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct BoardFlaws {
  double extent_m = 0.0;  // largest distance between two points
  bool is_flat = false;   // else a cube or a sail; nothing below is known then
  // Distances of the points from their plane, RMS and largest, and how much of the RMS their
  // uncertainty explains.
  double bend_m = 0.0, max_bend_m = 0.0, bend_sigma_m = 0.0;
  // By how much the markers are wider than high, as a fraction: paper shrinks and printers feed
  // more in one direction than in the other.
  double stretch = 0.0, stretch_sigma = 0.0;
  // Scatter of the markers' mean sides, as a fraction; 0 for fewer than three markers.
  double size_scatter = 0.0;
};

// The model is metric; `points` is the covariance of all its points.
BoardFlaws FindBoardFlaws(const Model& model, const PointCovariance& points);

}  // namespace velamap
