#include "exporters/cloth/surface_sigma.h"

#include <cmath>

#include <Eigen/Geometry>

#include "exporters/shape/shape_sigma.h"

namespace velamap {
namespace {

// Along `normal`, m^2.
std::optional<double> VarianceAt(const FittedSurface& fit, double u, double v,
                                 const Eigen::Vector3d& normal, const PointCovariance* covariance) {
  const std::optional<SurfaceDependence> dependence = DependenceAt(fit, u, v);
  if (!dependence) return std::nullopt;
  PointGradient gradient;
  for (std::size_t k = 0; k < fit.points.size(); ++k) {
    const double weight = dependence->point_weights[static_cast<Eigen::Index>(k)];
    AddPointGradient(fit.points[k].marker_id, fit.points[k].corner, weight * normal, &gradient);
  }
  const std::optional<double> by_markers_m = SigmaOf(covariance, gradient);
  if (!by_markers_m) return std::nullopt;
  return dependence->VarianceWith(*by_markers_m * *by_markers_m);
}

}  // namespace

std::optional<double> RmsSigma(const FittedSurface& fit, const PointCovariance* covariance) {
  constexpr int kNumCells = 12;  // along u and along v; each takes a product with the covariance
  double area = 0.0, sum_m2 = 0.0;
  for (int i = 0; i < kNumCells; ++i) {
    for (int j = 0; j < kNumCells; ++j) {
      const double u = (i + 0.5) / kNumCells, v = (j + 0.5) / kNumCells;
      const SurfaceJet jet = EvaluateJet(fit.surface, u, v);
      const std::optional<double> variance_m2 = VarianceAt(fit, u, v, jet.normal, covariance);
      if (!variance_m2) return std::nullopt;
      const double cell = jet.x_u.cross(jet.x_v).norm();
      area += cell;
      sum_m2 += cell * *variance_m2;
    }
  }
  return std::sqrt(sum_m2 / area);
}

}  // namespace velamap
