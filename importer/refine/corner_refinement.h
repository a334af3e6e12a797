// Refines a marker's corners to a fraction of a pixel: fits the whole marker, or its four sides
// where that fails.
//
// cv::cornerSubPix pulls the corners of a marker inwards by 0.1 to 0.4 px, which becomes a scale
// error of 0.4 to 6 % when the scale comes from the marker's side. A marker is fitted as a whole
// (pattern_fit.h). If that fails, each side is modelled as a step edge blurred by a Gaussian
// (edge_fit.h), whose place, bend, blur and grey levels are fitted by least squares to the pixels
// within a band around the side, and neighbouring sides intersect in the corners.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/pattern/image_formation.h"
#include "importer/pattern/known_marker.h"
#include "importer/pattern/refined_corners.h"

namespace velamap {

// Returns the corners with their uncertainty. `corners_px` and the result are in OpenCV's pixel
// frame (first pixel's centre at (0,0)), in order around the square; `num_cells` is the number of
// cells along a side with the border. Returns nothing if an edge has too little contrast or leaves
// the image, or if the fit moves a corner too far.
std::optional<RefinedCorners> RefineCornersBySides(const cv::Mat& gray,
                                                   const QuadCorners& corners_px, int num_cells);

// Fits the whole marker (corners as for FitPattern()), or its sides where that fails.
// `gray`: 8-bit, dark markers on light ground. The sides are fitted in linear light, because a tone
// curve shifts edges, and then moved back by ink spread and the other known shifts of edges.
// Returns nothing if both fail or move a corner too far.
std::optional<RefinedCorners> RefineCorners(const cv::Mat& gray, const QuadCorners& corners_px,
                                            const KnownMarker& marker,
                                            const ImageFormation& formation = ImageFormation());

}  // namespace velamap
