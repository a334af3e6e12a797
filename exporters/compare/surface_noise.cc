#include "exporters/compare/surface_noise.h"

namespace velamap {

SurfaceNoise::SurfaceNoise(const FittedSurface& fit, ComparedShape whose,
                           const AlignmentSensitivity& sensitivity,
                           const PointCovariance& covariance)
    : fit_(fit), noise_(sensitivity, whose, covariance) {}

std::optional<double> SurfaceNoise::VarianceAt(double u, double v,
                                               const Eigen::Vector3d& direction) const {
  const std::optional<SurfaceDependence> dependence = DependenceAt(fit_, u, v);
  if (!dependence) return std::nullopt;
  CornerGradient own;
  for (std::size_t k = 0; k < fit_.points.size(); ++k) {
    own[fit_.points[k]] = dependence->point_weights[static_cast<Eigen::Index>(k)] * direction;
  }
  const auto of_markers_m2 = noise_.VarianceAt(EvaluatePoint(fit_.surface, u, v), direction, own);
  if (!of_markers_m2) return std::nullopt;
  return dependence->VarianceWith(*of_markers_m2);
}

}  // namespace velamap
