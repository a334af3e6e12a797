// What the markers say about a surface: where each of them lies and how it is tilted. Private to
// this folder.

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
};

MarkerNoise DescribeNoise(const SortedInput& sorted);

// One term per observation: the mean of its points.
std::vector<SurfaceTerm> PlaceTerms(const std::vector<SurfaceObservation>& observations,
                                    const MarkerNoise& noise);

// Adds two terms per marker with corners: half the vectors between the middles of its opposite
// sides. `noise_factor` multiplies their sigmas.
void AddTiltTerms(const std::vector<SurfaceObservation>& observations, const MarkerNoise& noise,
                  double noise_factor, std::vector<SurfaceTerm>* terms);

// How much larger than their sigmas the residuals of the tilts are, compared with those of the
// places: the root of the ratio of two variance components (Förstner, "Ein Verfahren zur Schätzung
// von Varianz- und Kovarianzkomponenten", 1979). `smooth` fits the places and, if it has more
// terms, the tilts. 1 where the residuals do not tell.
double NoiseOfTilts(const std::vector<SurfaceObservation>& observations, const MarkerNoise& noise,
                    const SmoothSurface& smooth);

}  // namespace velamap
