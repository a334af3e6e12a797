// Rigid alignment of one frame's markers with a shape, by RANSAC (thesis section 3.4.1).

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

struct FrameAlignmentOptions {
  // A marker further than this from its place in the shape is an outlier, m. 0: the marker's own
  // side, which for the thesis's markers is its 100 mm, but at least three times the expected error
  // of its distance, which rules where a long lens sees small markers.
  double ransac_max_error_m = 0.0;
  int max_num_trials = 300;
  // Fewest inliers of an accepted alignment. One marker fixes a transformation that nothing
  // confirms; two confirm each other.
  int min_num_inliers = 2;
  std::uint32_t random_seed = 0;
};

struct FrameAlignment {
  Rigid3 shape_from_cam;
  std::vector<int> inlier_ids;   // markers in both that agree, ascending
  std::vector<int> outlier_ids;  // markers in both that do not, ascending
  double rms_error_m = 0.0;      // over the inliers' points that were used
};

// Thesis, equation 3.1: triples of marker centres are sampled, and the centres of all inliers give
// the transformation. Where fewer than four markers are shared, or their centres lie on a line,
// centres do not suffice: hypotheses then come from the corners of single markers, each with both
// of its pose solutions, and inliers' corners take part. Nothing if fewer than min_num_inliers
// agree.
std::optional<FrameAlignment> AlignFrame(const FrameShape& frame, const ShapePoints& shape,
                                         const Layout& layout,
                                         const FrameAlignmentOptions& options);

// The pose solution of a marker that fits its place in the shape better; 0 where it has one only.
int BestSolution(const FrameMarker& marker, const Rigid3& shape_from_cam,
                 const MarkerPoints& x_in_shape);

}  // namespace velamap
