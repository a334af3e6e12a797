#include "exporters/compare/surface_noise.h"

#include <algorithm>
#include <vector>

namespace velamap {

SurfaceNoise::SurfaceNoise(const FittedSurface& fit, const MarkerShape& shape_in_reference,
                           ComparedShape whose, const AlignmentSensitivity& sensitivity,
                           const PointCovariance& covariance)
    : fit_(fit) {
  if (covariance.IsEmpty() || fit.marker_ids.empty()) return;
  std::vector<MarkerInReference> markers;
  for (const int id : fit.marker_ids) {
    markers.push_back({id, *FindWholeMarker(shape_in_reference, id)->x_in_shape_m[0]});
  }
  covariance_m2_ = sensitivity.JointCovariance(markers, whose, covariance);
}

std::optional<double> SurfaceNoise::VarianceAt(double u, double v,
                                               const Eigen::Vector3d& direction) const {
  const std::optional<SurfaceDependence> dependence = DependenceAt(fit_, u, v);
  if (!dependence || !covariance_m2_) return std::nullopt;
  const Eigen::VectorXd& weights = dependence->marker_weights;
  Eigen::VectorXd gradient(3 * weights.size());
  for (Eigen::Index k = 0; k < weights.size(); ++k) {
    gradient.segment<3>(3 * k) = weights[k] * direction;
  }
  const double of_markers_m2 = gradient.dot(*covariance_m2_ * gradient);
  return std::max(of_markers_m2, dependence->noise_variance_m2) + dependence->smoothing_variance_m2;
}

}  // namespace velamap
