// Rigid alignment of one frame's markers with a shape, by RANSAC (thesis section 3.4.1).

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

struct FrameAlignmentOptions {
  // A marker farther than this from its position in the shape is an outlier, m. 0: the marker's
  // side (100 mm in the thesis), but at least three sigmas of its distance from the camera, which
  // exceed the side for small markers behind a long lens.
  double ransac_max_error_m = 0.0;
  int max_num_trials = 300;
  // Fewest inliers of an accepted alignment. One marker determines the transformation, a second one
  // confirms it.
  int min_num_inliers = 2;
  std::uint32_t random_seed = 0;
};

struct FrameAlignment {
  Rigid3 shape_from_cam;
  std::vector<int> inlier_ids;   // shared markers that agree, ascending
  std::vector<int> outlier_ids;  // shared markers that do not agree, ascending
  double rms_error_m = 0.0;      // over the points of the inliers
};

bool IsOutlier(const FrameAlignment& alignment, int marker_id);

// Thesis, equation 3.1: samples triples of marker centres and estimates the transformation from the
// centres of all inliers. Where fewer than four markers are shared or their centres are collinear,
// hypotheses come from the corners of single markers instead, one for each of their pose solutions,
// and the corners of all inliers give the transformation. Returns nothing if fewer than
// min_num_inliers agree.
std::optional<FrameAlignment> AlignFrame(const FrameShape& frame, const ShapePoints& shape,
                                         const Layout& layout,
                                         const FrameAlignmentOptions& options);

}  // namespace velamap
