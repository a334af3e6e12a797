// The noise of a surface that is compared, from the joint covariance of the markers that it was
// fitted to, so that it agrees with the sigmas of the markers themselves.

#pragma once

#include <optional>

#include <Eigen/Core>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/surface/surface.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

class SurfaceNoise {
 public:
  // `fit` belongs to the markers of the shape or of its reference (`whose`), in the frame of the
  // reference. `covariance` is that of its corners, in its own frame. Both must outlive this.
  SurfaceNoise(const FittedSurface& fit, ComparedShape whose,
               const AlignmentSensitivity& sensitivity, const PointCovariance& covariance);

  // Variance of the surface at a place along a unit vector: from the noise of its markers, from
  // what this does to the alignment, and from the smoothing (SurfaceDependence::VarianceWith).
  // Nothing if a sigma that it depends on is unknown, or if the surface interpolates.
  std::optional<double> VarianceAt(double u, double v, const Eigen::Vector3d& direction) const;

 private:
  const FittedSurface& fit_;
  const AlignedNoise noise_;
};

}  // namespace velamap
