// The observations of a surface: where each marker lies and how it is tilted.

#pragma once

#include <map>
#include <vector>

#include "exporters/surface/surface_ends.h"
#include "exporters/surface/surface_parameters.h"
#include "exporters/surface/surface_smoother.h"

namespace velamap {

// The sigmas of every marker, and the way of smoothing that follows from them.
struct MarkerNoise {
  std::map<int, double> sigma_m, tilt_sigma_m;
  double edge_sigma_m = 1.0;
  Smoothing smoothing = Smoothing::kCrossValidation;
  bool is_nominal = false;  // kKnownSigma without any sigma: the surface has none either
};

MarkerNoise DescribeNoise(const SortedInput& sorted);

// One term per observation: the mean of its points.
std::vector<SurfaceTerm> PlaceTerms(const std::vector<SurfaceObservation>& observations,
                                    const MarkerNoise& noise);

// How far a term's sum of points lies from that of the surface, along the normal at its
// observation, m; without its weight.
double NormalResidual(const SplineSurface& surface,
                      const std::vector<SurfaceObservation>& observations, const SurfaceTerm& term);

// Adds two terms per marker with corners: half the vectors between the middles of its opposite
// sides, with these sigmas by marker id.
void AddTiltTerms(const std::vector<SurfaceObservation>& observations,
                  const std::map<int, double>& tilt_sigma_m, std::vector<SurfaceTerm>* terms);

// The sigmas of the tilts as the residuals show them, by marker id. All are as much larger than
// those of `noise` as the residuals of the tilts are, compared with those of the places, but never
// smaller: the ratio of two variance components (Förstner, "Ein Verfahren zur Schätzung von
// Varianz- und Kovarianzkomponenten", 1979), from medians. A marker that is tilted relative to the
// others, such as a peeling one, gets Cauchy's weight. `smooth` fits the places and, if it has more
// terms, the tilts.
std::map<int, double> TiltSigmas(const std::vector<SurfaceObservation>& observations,
                                 const MarkerNoise& noise, const SmoothSurface& smooth);

}  // namespace velamap
