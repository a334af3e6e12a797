// Pixels that a camera recorded at the end of its range.
//
// White paper in the sun and the bright side of a sharpened edge are often clipped at 255, the dark
// side at 0. Such a pixel gives a limit of its value, not the value. Taken as it is, it pulls the
// light level of the marker down, and undoing the sharpening spreads its error to the pixels around
// it, which moves edges outwards or inwards.

#pragma once

#include <opencv2/core.hpp>

#include "importer/pattern/image_formation.h"
#include "importer/pattern/pattern_problem.h"

namespace velamap {

// Whether pixels of the box are clipped. False where a fifth of them or more is clipped at each
// end, as in drawings: if neither level is known, the edges cannot be located, and the values are
// taken as they are.
bool HasClippedPixels(const cv::Mat& gray, const cv::Rect& box);

// RefinePatternFit() with the values that a camera without limits would have recorded, by the model
// `minimum`, in place of the clipped ones, and with no weight for these pixels. Repeated until that
// moves no corner further than `tolerance_px`. `gray` and `formation` are those that the problem
// was made with; HasClippedPixels() holds for them. False for a singular system.
bool RefineBeyondClipping(const cv::Mat& gray, const ImageFormation& formation, int max_pixels,
                          double tolerance_px, PatternProblem* problem, PatternMinimum* minimum);

}  // namespace velamap
