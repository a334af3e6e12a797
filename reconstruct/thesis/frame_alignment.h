// Rigid alignment of one frame's markers with a shape, by RANSAC (thesis section 3.4.1).

#pragma once

#include <optional>
#include <vector>

#include "reconstruct/geometry/frame_shape.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

struct FrameAlignment {
  Rigid3 shape_from_cam;
  std::vector<int> inlier_ids;   // shared markers that agree, ascending
  std::vector<int> outlier_ids;  // shared markers that do not agree, ascending
  double rms_error_m = 0.0;      // over the points of the inliers
};

bool IsOutlier(const FrameAlignment& alignment, int marker_id);

// Thesis, equation 3.1: samples triples of marker centres and estimates the transformation from the
// centres of all inliers. If fewer than four markers are shared or their centres are collinear,
// hypotheses come from the corners of single markers instead, one for each of their pose solutions,
// and the corners of all inliers give the transformation. Returns nothing if fewer than
// min_num_inliers agree: one marker determines the transformation, a second one confirms it.
//
// A marker farther than ransac_max_error_m from its position in the shape is an outlier. If that is
// 0, the limit is the marker's side (100 mm in the thesis), but at least three sigmas of its
// distance from the camera, which exceed the side for small markers behind a long lens.
std::optional<FrameAlignment> AlignFrame(const FrameShape& frame, const ShapePoints& shape,
                                         const Layout& layout, const RegistrationOptions& options);

}  // namespace velamap
