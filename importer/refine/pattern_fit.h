// Corners of a small marker by a least-squares fit of a model of the whole marker to its pixels.
//
// When cells are only one to four px wide, the blur of each edge reaches the next one and a side
// cannot be fitted alone. The cells of the marker are known, so the model is:
//
//   I(x) = (1 + gradient . x) * (dark + (light - dark) * sum_ij cell_ij a_i(u) b_j(v))
//   x = H(u, v) + 4 u (1 - u) bend_u + 4 v (1 - v) bend_v
//
// H is the homography of the four corners; the bends (px) are due to cloth or a lens; a_i and b_j
// are the unit steps of column i and row j blurred by a Gaussian (px; separate widths along u and v
// model motion blur as well). The black square is surrounded by one cell of quiet zone, and that by
// the surroundings as the image shows them. The light cells of the marker have a level of their
// own: with the level of the quiet zone, markers of 50 px in real photographs, and the same scaled
// down to 17 px, came out another 0.4 % too small.

#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/refine/refined_corners.h"

namespace velamap {

// `cells`: 8-bit, square, with the black border, zero for black; row 0 runs from corner 0 to 1 and
// column 0 from corner 0 to 3. Corners in OpenCV's pixel frame. Nothing if the marker leaves the
// image, has too little contrast or does not look like its cells.
std::optional<RefinedCorners> FitPattern(const cv::Mat& gray, const QuadCorners& corners_px,
                                         const cv::Mat& cells);

}  // namespace velamap
