// The fit of a whole marker's pixels as a least-squares problem: pattern_fit.h gives the model.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/pattern/fit_equations.h"
#include "importer/pattern/image_formation.h"
#include "importer/pattern/known_marker.h"
#include "importer/pattern/pattern_model.h"

namespace velamap {

// The last fit of a marker uses at most this many pixels and ends when its corners change by less
// than this.
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
};

// The best parameters so far, and the normal equations there.
struct PatternMinimum {
  PatternParameters::Vector parameters;
  PatternEquations equations;
};

// Corners as in FitPattern(). Returns nothing if the marker leaves the image, has too many cells or
// too little contrast. `formation` must outlive the problem. Sets the initial parameters.
std::optional<PatternProblem> MakePatternProblem(const cv::Mat& gray, const QuadCorners& corners_px,
                                                 const KnownMarker& marker,
                                                 const ImageFormation& formation,
                                                 PatternMinimum* minimum);

// Grey levels between the dark and the light cells.
double ContrastOf(const PatternProblem& problem, const PatternMinimum& minimum);

// Sets the constants of the model that depend on the image formation.
void SetFormation(const ImageFormation& formation, PatternProblem* problem);

// Sets the pixels, and the scattered light in them that the model adds to its own.
void SetPatch(GrayPatch patch, PatternProblem* problem);

// The prior of the widths of the quiet zone, where that is known of all markers.
void SetQuietZonePrior(const ImageFormationParameters& formation, PatternProblem* problem);

// Reads the surroundings of the quiet zone again and fits all parameters to about `max_pixels`
// pixels, until a step moves no corner further than `tolerance_px`. Returns false for a singular
// system.
bool RefinePatternFit(int max_pixels, double tolerance_px, PatternProblem* problem,
                      PatternMinimum* minimum);

// From the initial parameters: a coarse fit to some pixels, then fine fits to more pixels. Returns
// false if the image does not show such a marker.
bool FitPatternInPasses(PatternProblem* problem, PatternMinimum* minimum);

}  // namespace velamap
