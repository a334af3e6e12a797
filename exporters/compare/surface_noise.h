// The noise of a surface that is compared, from the joint covariance of the markers that it was
// fitted to, so that it agrees with the sigmas of the markers themselves. Private to this folder.

#pragma once

#include <optional>

#include <Eigen/Core>

#include "exporters/compare/comparison_sigma.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/surface/surface.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

class SurfaceNoise {
 public:
  // `fit` belongs to the markers of `shape_in_reference`. `covariance` is that of the corners of
  // the shape or of its reference (`whose`), in its own frame. `fit` must outlive this.
  SurfaceNoise(const FittedSurface& fit, const MarkerShape& shape_in_reference, ComparedShape whose,
               const AlignmentSensitivity& sensitivity, const PointCovariance& covariance);

  // Variance of the surface at a place along a unit vector: from the noise of its markers, from
  // what this does to the alignment, and from the smoothing. Where the residuals of the surface
  // show more noise than the sigmas of the markers say, theirs counts. Nothing if a sigma that it
  // depends on is unknown, or if the surface interpolates.
  std::optional<double> VarianceAt(double u, double v, const Eigen::Vector3d& direction) const;

 private:
  const FittedSurface& fit_;
  std::optional<Eigen::MatrixXd> covariance_m2_;  // three rows for each marker of the fit
};

}  // namespace velamap
