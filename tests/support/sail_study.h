// Sails with exact truth and noisy markers, and how near a fitted surface comes to them.

#pragma once

#include <functional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "exporters/formats/surface_spline.h"
#include "exporters/surface/surface_input.h"
#include "tests/support/cloth.h"

namespace velamap {

// A sail of random size, camber, draft, twist, mast bend and roach, upright, bulging to -y.
Surface DrawSail(std::mt19937* random);

// Lines of markers at heights `vs` of a sail. Line k reaches from first_us[k] to last_us[k].
struct SailLines {
  std::vector<double> vs, first_us, last_us;
};

// Seven lines that begin and end 50 to 120 mm from the edges of the cloth.
SailLines DrawLines(const Surface& sail, std::mt19937* random);

// Sigma of a marker at a fraction of its line: three times as large at the ends, which fewer
// pictures show.
double MarkerSigma(double sigma_m, double fraction);

// Markers every 150 mm of the lines, and on a vertical line near the middle of the chords four
// between each pair; each with noise of its sigma, which it states.
SurfaceInput DrawMarkers(const Surface& sail, const SailLines& lines, double sigma_m,
                         std::mt19937* random);

// A place between the outer markers, by fractions of the lines and of their height.
struct SurfaceError {
  double along = 0.0, up = 0.0;
  double distance_m = 0.0;       // of the true place from the surface, along its normal
  double curvature = 0.0;        // of the true sail along its chord, 1/m
  double found_curvature = 0.0;  // of the surface in the same direction, 1/m
  bool is_inside = false;        // one marker from luff and leech, one line from foot and head
  Eigen::Vector3d x_in_sail_m = Eigen::Vector3d::Zero();
};

constexpr int kNumPlacesAlong = 13;
constexpr int kNumPlacesPerGap = 2;  // between two lines

// At the places of a grid, along the lines first.
std::vector<SurfaceError> MeasureSurface(const SplineSurface& surface, const Surface& sail,
                                         const SailLines& lines);

}  // namespace velamap
