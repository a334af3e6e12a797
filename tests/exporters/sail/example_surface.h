// Surfaces in closed form with markers on them, for the tests of surfaces and their files.

#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "exporters/sail/surface.h"

namespace velamap {

using SurfaceTruth = std::function<Eigen::Vector3d(double u, double v)>;  // m

// A twisted four-cornered patch, 3 m by 5 m.
Eigen::Vector3d BilinearPatch(double u, double v);

// An arc of a cylinder of radius 4 m over 40 degrees, 3 m high: the sail of a drawing board.
Eigen::Vector3d CylinderSail(double u, double v);

// A sail of 6 m: chord 3 m at the foot and 1 m at the head, 10 to 12 % camber, 15 degrees of twist.
Eigen::Vector3d TwistedSail(double u, double v);

// `num_lines` lines of `num_markers`, at equal steps of u and v; ids count up along the lines. No
// sigmas.
SurfaceInput MarkersOn(const SurfaceTruth& truth, int num_lines, int num_markers);

// Of the truth's points on a dense grid from the surface: the largest distance, m.
double LargestDistance(const SplineSurface& surface, const SurfaceTruth& truth);

}  // namespace velamap
