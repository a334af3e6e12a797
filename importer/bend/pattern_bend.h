// How the distortion of a lens, or a curved surface, bends a marker within its corners. The sides
// of a flat marker are straight only where the lens does not distort; the homography of the four
// corners is off by up to a pixel in the middle of large markers seen through a wide lens. Fits
// without this find the corners too far outside, because the middle of a side outweighs its ends.

#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>

#include "importer/camera/camera.h"
#include "importer/geometry/quad.h"

namespace velamap {

// Displacement of the place (u, v) of the unit square from where the homography of the corners puts
// it, to third order:
//
//   h(u) (c0 + (2v - 1) c1 + (2u - 1) c2) + h(v) (c3 + (2u - 1) c4 + (2v - 1) c5)
//
// with h(t) = 4t (1 - t).
struct PatternBend {
  using Coefficients = Eigen::Matrix<double, 2, 6>;
  using Terms = Eigen::Matrix<double, 6, 1>;

  Coefficients coefficients_px = Coefficients::Zero();  // c0 to c5

  static Terms TermsAt(double u, double v);  // the factors of c0 to c5

  Eigen::Vector2d At(double u, double v) const;
};

// The bend that fits displacements best. `displacement_px` returns the displacement, px, of a place
// of the unit square; the bend is zero if it returns nothing for one of them.
PatternBend BendByDisplacements(
    const std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& uv)>&
        displacement_px);

// For the flat marker with these corners, in OpenCV's pixel frame. Zero for a camera without
// distortion, and where the distortion cannot be inverted.
PatternBend BendByLens(const Camera& camera, const QuadCorners& corners_px);

// By how much a fit that ignores the bend misplaces the corners, px; to be subtracted from them.
QuadCorners CornerShiftsByBend(const PatternBend& bend, const QuadCorners& corners_px);

}  // namespace velamap
