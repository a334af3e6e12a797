// Random sails with exact truth and noisy markers, and the errors of surfaces fitted to these.

#pragma once

#include <random>
#include <vector>

#include <Eigen/Core>

#include "exporters/formats/surface_spline.h"
#include "exporters/surface/surface_input.h"
#include "tests/support/clip/cloth.h"

namespace velamap {

// An upright sail of random size, camber, draft, twist, mast bend and roach. It bulges towards -y.
Surface DrawSail(std::mt19937* random);

// Lines of markers at the heights `vs` of a sail. Line k extends from first_us[k] to last_us[k].
struct SailLines {
  std::vector<double> vs, first_us, last_us;
};

// Seven lines whose ends are 50 to 120 mm from the edges of the cloth.
SailLines DrawLines(const Surface& sail, std::mt19937* random);

// The sigma of a marker at a fraction of its line, m. It is three times as large at the ends, which
// fewer pictures show.
double MarkerSigma(double sigma_m, double fraction);

// Markers every 150 mm along the lines, and four between each pair of lines on a vertical line near
// the middle of the chords. Each has four corners on the sail, noise of MarkerSigma(), half as much
// in its tilts, and states these sigmas.
SurfaceInput DrawMarkers(const Surface& sail, const SailLines& lines, double sigma_m,
                         std::mt19937* random);

// The errors of a surface at a place between the outer markers.
struct SurfaceError {
  // The place, as fractions of the line and of the height of the lines.
  double along = 0.0, up = 0.0;
  double distance_m = 0.0;       // of the true place from the surface, along its normal
  double curvature = 0.0;        // of the true sail along its chord, 1/m
  double found_curvature = 0.0;  // of the fitted surface in the same direction, 1/m
  // Whether it is at least one marker away from luff and leech and one line from foot and head.
  bool is_inside = false;
  Eigen::Vector3d x_in_sail_m = Eigen::Vector3d::Zero();
};

constexpr int kNumPlacesAlong = 13;
constexpr int kNumPlacesPerGap = 2;  // between two lines

// The errors at the places of a grid, in the order of the heights and then along each line.
std::vector<SurfaceError> MeasureSurface(const SplineSurface& surface, const Surface& sail,
                                         const SailLines& lines);

}  // namespace velamap
