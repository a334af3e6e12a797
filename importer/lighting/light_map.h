// Where on a marker the light differs from that of a fit, from the residuals of its pixels.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "importer/lighting/lighting.h"

namespace velamap {

// A pixel of the fit, for the light that falls on it.
struct LitPixel {
  Eigen::Vector2d place;  // as in Lighting
  double residual = 0.0;  // modelled minus recorded, grey levels
  double by_log_light = 0.0;
};

// For each part of a marker, the light that the model lacks there: the mean logarithm of the ratio
// of the recorded light to the modelled one.
struct LightMap {
  struct Part {
    Eigen::Vector2d place;
    double lack = 0.0, weight = 0.0;  // inverse variance, for noise of one grey level
  };
  std::vector<Part> parts;
  double excess = 0.0;     // squared scatter of the parts over what the noise within them explains
  double amplitude = 0.0;  // RMS of the lack
};

LightMap MapLight(const std::vector<LitPixel>& pixels);

struct FoundBand {
  Lighting::Band band;
  double unexplained = 1.0;  // share of the map's squares
};

// The band that best explains the map together with a smooth light (constant, slope and curvature).
// The map must not be empty.
FoundBand FindBand(const LightMap& map);

}  // namespace velamap
