// The fit of a whole marker's pixels as a least-squares problem: pattern_fit.h gives the model.

#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/pattern/fit_equations.h"
#include "importer/pattern/image_formation.h"
#include "importer/pattern/pattern_model.h"

namespace velamap {

// Of the last fit of a marker.
constexpr int kMaxPatternPixels = 1000;
constexpr double kPatternTolerancePx = 0.005;

using PatternEquations = FitEquations<PatternParameters::kCount>;

// The pixels around a marker, its model, and the priors of the parameters. Refers to the cells and
// the tone curve that it was made with.
struct PatternProblem {
  cv::Mat cells;
  GrayPatch patch;
  cv::Rect box;  // of the pixels that the model may cover, in the image
  PatternModel model;
  PatternParameters::Vector mean, weight;  // priors
  // Pixels that the model misses by more show something in front of the marker, and do not count.
  double max_residual_gray = std::numeric_limits<double>::infinity();
};

// The best parameters so far, and the normal equations there.
struct PatternMinimum {
  PatternParameters::Vector parameters;
  PatternEquations equations;
};

// `cells` and corners as in FitPattern(). Nothing where the marker leaves the image, has too many
// cells or too little contrast. `formation` must outlive the problem. Sets the initial parameters.
std::optional<PatternProblem> MakePatternProblem(const cv::Mat& gray, const QuadCorners& corners_px,
                                                 const cv::Mat& cells,
                                                 const ImageFormation& formation,
                                                 PatternMinimum* minimum);

// The prior of the widths of the quiet zone, where that is known of all markers.
void SetQuietZonePrior(const ImageFormationParameters& formation, PatternProblem* problem);

// Reads the surroundings of the quiet zone again and fits all parameters to about `max_pixels`
// pixels, until a step moves no corner further than `tolerance_px`. False for a singular system.
bool RefinePatternFit(int max_pixels, double tolerance_px, PatternProblem* problem,
                      PatternMinimum* minimum);

// From the initial parameters: a coarse fit to some pixels, then fine fits to more pixels. False if
// the image does not show such a marker.
bool FitPatternInPasses(PatternProblem* problem, PatternMinimum* minimum);

// Fits again without the pixels that show something else: a rope or its shadow across the marker, a
// glint, dirt. These are missed by far more than the noise and by a good part of the contrast.
// Leaves the fit as it is where there are hardly any, or too many to be foreign. False for a
// singular system or a refit that has lost the marker.
bool RefitWithoutForeignPixels(PatternProblem* problem, PatternMinimum* minimum);

}  // namespace velamap
