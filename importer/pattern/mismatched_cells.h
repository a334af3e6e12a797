// Cells of a fitted marker that look as if they were of the other colour.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/pattern/pattern_problem.h"

namespace velamap {

// Column and row of each cell in the middle of which the image is darker than the model of a light
// cell, or lighter than the model of a dark cell, by more than a quarter of the contrast. An object
// in front of the marker may cause this as well as a misread code.
std::vector<cv::Point> MismatchedCells(const PatternProblem& problem,
                                       const PatternMinimum& minimum);

}  // namespace velamap
