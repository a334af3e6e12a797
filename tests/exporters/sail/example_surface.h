// Surfaces in closed form with markers.

#pragma once

#include <functional>

#include <Eigen/Core>

#include "exporters/surface/surface.h"

namespace velamap {

using SurfaceTruth = std::function<Eigen::Vector3d(double u, double v)>;  // m

// A twisted four-cornered patch, 3 m by 5 m.
Eigen::Vector3d BilinearPatch(double u, double v);

// An arc of 40 degrees of a cylinder with a radius of 4 m, 3 m high.
Eigen::Vector3d CylinderSail(double u, double v);

// A sail of 6 m: chord 3 m at the foot and 1 m at the head, 10 to 12 % camber, 15 degrees of twist.
Eigen::Vector3d TwistedSail(double u, double v);

// `num_lines` lines of `num_markers`, at equal steps of u and v; ids count up along the lines. No
// sigmas.
SurfaceInput MarkersOn(const SurfaceTruth& truth, int num_lines, int num_markers);

// The same with four corners on the surface, `du` and `dv` from the middle of each marker.
SurfaceInput CornersOn(const SurfaceTruth& truth, int num_lines, int num_markers, double du,
                       double dv);

// With a sigma of 0 for all markers, so that the surface goes through them.
SurfaceInput AsExact(SurfaceInput input);

template <typename Function>
void ForEachMarker(SurfaceInput* input, const Function& function) {
  for (SurfaceLine& line : input->lines) {
    for (auto& marker : line.markers) {
      if (marker) function(&*marker);
    }
  }
  for (SurfaceMarker& marker : input->markers) function(&marker);
}

// With its corners.
void MoveMarker(const Eigen::Vector3d& move_m, SurfaceMarker* marker);

// Moves all markers by normal noise, which becomes their sigma if `with_sigma`. Corners get twice
// as much each, so that their mean has this sigma.
void AddNoise(double sigma_m, bool with_sigma, int seed, SurfaceInput* input);

// The largest distance of a marker in use from the surface, m.
double LargestResidual(const FittedSurface& fitted);

// Root mean square distance of the true points from the surface, away from the edges, m.
double TruthRms(const SplineSurface& surface, const SurfaceTruth& truth);

// The largest distance of the true points of a dense grid from the surface, m.
double LargestDistance(const SplineSurface& surface, const SurfaceTruth& truth);

// Seven lines of nine markers on TwistedSail, with noise and sigmas.
SurfaceInput NoisySail();

}  // namespace velamap
