// Cells of a fitted marker that look as if they were of the other colour.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/pattern/pattern_problem.h"

namespace velamap {

// Column and row of each cell in whose middle the image is darker than the model of a light cell,
// or lighter than that of a dark one, by a quarter of the contrast. Where something lies in front
// of the marker, it may cover some.
std::vector<cv::Point> UnlikeCells(const PatternProblem& problem, const PatternMinimum& minimum);

}  // namespace velamap
