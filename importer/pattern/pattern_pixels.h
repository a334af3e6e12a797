// The pixels of a marker and around it that a fit uses.

#pragma once

#include <vector>

#include "importer/lanes/float_lanes.h"
#include "importer/pattern/pattern_problem.h"

namespace velamap {

struct ChosenPixels {
  struct Group {
    Floats x, y;  // relative to center_px of the model
    Floats gray;
    Floats root_weight;
  };
  std::vector<Group> groups;
  int count = 0;  // the last group may be incomplete
};

// Chooses about `max_pixels` of the pixels that the model covers with these parameters. If there
// are more, it takes every k-th pixel near an edge, because these determine the corners, and a few
// others, which determine the grey levels. It leaves out pixels that the patch excludes and, if
// they have no weight, those at the corners of outlines.
ChosenPixels ChoosePixels(const PatternProblem& problem,
                          const PatternParameters::Vector& parameters, int max_pixels);

struct PixelResidual {
  cv::Point in_patch;
  double absolute_gray;      // between the model and the pixel, grey levels
  double slope_gray_per_px;  // of the model there
};

// In the order of the pixels.
std::vector<PixelResidual> Residuals(const PatternProblem& problem,
                                     const PatternParameters::Vector& parameters,
                                     const ChosenPixels& pixels);

}  // namespace velamap
