// Corners of a marker by a least-squares fit of a model of the whole marker to its pixels.
//
// A fit of the outer sides alone cannot tell a camera that sees black squares too small from a
// small marker. The cells of the marker are known, and its inner edges have both polarities, so the
// light is modelled as
//
//   L(x) = (1 + gradient . x) * (dark + (light - dark) * sum_ij cell_ij a_i(u) b_j(v))
//   x = H(u, v) + 4 u (1 - u) bend_u + 4 v (1 - v) bend_v + lens(u, v)
//
// and becomes grey values by the image formation (image_formation.h). H is the homography of
// the four corners; the bends (px) are due to cloth, and lens(u, v) to the lens (pattern_bend.h);
// a_i and b_j are the unit steps of column i and row j blurred by a Gaussian (px; separate widths
// along u and v model motion blur as well). A quiet zone surrounds the black square; beyond its
// width, which is fitted for each side, lie the surroundings as the image shows them.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/pattern/image_formation.h"
#include "importer/pattern/known_marker.h"
#include "importer/pattern/refined_corners.h"

namespace velamap {

// Corners in OpenCV's pixel frame. Returns nothing if the marker leaves the image, has too little
// contrast or does not look like its cells.
std::optional<RefinedCorners> FitPattern(const cv::Mat& gray, const QuadCorners& corners_px,
                                         const KnownMarker& marker,
                                         const ImageFormation& formation);

}  // namespace velamap
