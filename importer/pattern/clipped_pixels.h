// Pixels that a camera recorded at the end of its range.
//
// White paper in the sun and the bright side of a sharpened edge are often clipped at 255, the dark
// side at 0. Such a pixel gives only a limit of its value. If it were used as it is, it would lower
// the light level of the marker, and undoing the sharpening would spread its error to neighbouring
// pixels, which moves edges outwards or inwards.

#pragma once

#include <opencv2/core.hpp>

#include "importer/pattern/image_formation.h"
#include "importer/pattern/pattern_problem.h"

namespace velamap {

// Whether pixels of the box are clipped. Returns false if a fifth of them or more is clipped at
// each end, as in drawings: with neither level known, edges could not be located, so the values are
// used as they are.
bool HasClippedPixels(const cv::Mat& gray, const cv::Rect& box);

// RefinePatternFit() with the clipped values replaced by those that, according to the model
// `minimum`, a camera without limits would have recorded, and with no weight for these pixels.
// Repeated until no corner moves farther than `tolerance_px`. `gray` and `formation` are those that
// the problem was made with; HasClippedPixels() holds for them. Returns false for a singular
// system.
bool RefineBeyondClipping(const cv::Mat& gray, const ImageFormation& formation, int max_pixels,
                          double tolerance_px, PatternProblem* problem, PatternMinimum* minimum);

}  // namespace velamap
