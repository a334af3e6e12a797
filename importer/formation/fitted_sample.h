// A marker and its surroundings as a sample of the image formation, fitted with given parameters.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/geometry/quad.h"
#include "importer/lanes/float_lanes.h"
#include "importer/pattern/image_formation.h"
#include "importer/pattern/known_marker.h"
#include "importer/pattern/pattern_problem.h"

namespace velamap {

struct FormationSample {
  cv::Mat gray;            // 8 bit: the marker with half a side around it, dark cells dark
  QuadCorners corners_px;  // OpenCV's pixel frame of `gray`, to a pixel
  KnownMarker marker;
  bool may_bend = false;  // with a curved surface, or by an unknown lens (sample_bend.h)
};

struct SamplePlace {
  cv::Point in_box;  // a pixel of problem.box, relative to its top left corner
  bool is_at_outline_corner;
};

// A sample with its fit. Refers to the image formation that it was fitted with.
struct FittedSample {
  cv::Mat gray;
  bool may_bend = false;
  PatternBend lens_bend;  // of the known marker; sample_bend.h adds that of the surface
  PatternProblem problem;
  PatternMinimum minimum;
  std::vector<SamplePlace> places;  // of the pixels near edges
  std::vector<float> residuals;     // at these places; empty: the fit failed
};

// Up to kLanes neighbours in `places`, as the model takes them.
struct PlaceGroup {
  std::size_t begin = 0, end = 0;                 // in sample.places
  Floats from_center_x_px{}, from_center_y_px{};  // from the center of the problem's model
};
PlaceGroup PlaceGroupAt(const FittedSample& sample, std::size_t begin);

// Grey value of the picture there, from which the sharpening has been removed.
float RecordedGray(const FittedSample& sample, const SamplePlace& place);

// Whether the pixel gives only a limit of the value there, with which the fit agrees; the residual
// is zero.
bool IsClipped(const FittedSample& sample, const SamplePlace& place);

// Returns nothing if the fit fails. No residuals yet: RefitSample() computes them.
std::optional<FittedSample> FitSample(const FormationSample& sample,
                                      const ImageFormation& formation);

// Fits a sample again, starting from its fit with the tone curve `before`. All pixels of most
// samples count and the tolerance is small, so that differences of residuals give derivatives. A
// fit that fails or loses the marker leaves the sample where it was, without residuals.
void RefitSample(const ImageFormation& formation, const ToneCurve& before, FittedSample* sample);

}  // namespace velamap
