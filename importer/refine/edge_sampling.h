// Samples the pixels around one side of a marker for the fit of edge_fit.h.

#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/refine/edge_fit.h"

namespace velamap {

// One side from corner 0 to 1 of a quad turned to start there; the marker lies inwards of it.
struct Side {
  Eigen::Vector2d middle_px, along, outward;  // unit vectors
  double half_length_px;
};

// Linear in s along the side.
struct LinearInS {
  double middle, slope;
  double operator()(double s) const { return middle + slope * s; }
};

// A line of the print parallel to the side, at v in the unit square: its distance from the side,
// and the place u on it opposite to a place s of the side.
struct Parallel {
  LinearInS depth_px, u;
};

// Places along a side at which the grey levels beyond the border and the quiet zone are read.
constexpr int kNumPlaces = 33;
using GrayLine = std::array<float, kNumPlaces>;

// The constants of the fit of one side.
struct SideModel {
  Side side, previous, next;
  GrayLine inner_gray, outer_gray;
  Parallel inner, outer;
  double dark, light;  // grey levels
  double blur_px;
};

// Side `side_idx` (from corner side_idx on) of a quad in OpenCV's pixel frame.
SideModel MakeSideModel(const cv::Mat& gray, const QuadCorners& quad_px, int side_idx,
                        int num_cells, double blur_px);

// All pixels no further than `band_px` from the side, or every k-th row or column of them, about
// `max_samples`. The ends of the side, where its blur mixes with that of the next sides, are left
// out: a side that is no longer than its blur has no samples.
void SampleSide(const cv::Mat& gray, const SideModel& model, double band_px, int max_samples,
                EdgeSamples* samples);

// The prior of the fit of one side. It holds the bend small, because a lens or curved cloth bends a
// side by a few thousandths of its length, and on a short side noise would be mistaken for a bend.
EdgePrior MakeEdgePrior(const SideModel& model);

}  // namespace velamap
