#include "exporters/shape/known_distances.h"

#include <cmath>

#include "exporters/shape/shape_sigma.h"

namespace velamap {

double CheckedDistance::DifferenceSigma() const {
  return std::hypot(known.sigma_m, sigma_m.value_or(0.0));
}

double CheckedDistance::DifferenceInSigmas() const {
  return (distance_m.value() - known.length_m) / DifferenceSigma();
}

bool CheckedDistance::FailsAsCheck() const {
  return distance_m && IsCheck() && std::abs(DifferenceInSigmas()) > kMaxCheckSigmas;
}

std::vector<CheckedDistance> CheckDistances(const MarkerShape& shape, const Layout& layout,
                                            const PointCovariance* covariance) {
  std::vector<CheckedDistance> checked;
  for (const KnownDistance& known : layout.distances) {
    checked.push_back({known, std::nullopt, std::nullopt});
    const ShapeMarker* marker1 = FindMarker(shape, known.marker_id1);
    const ShapeMarker* marker2 = FindMarker(shape, known.marker_id2);
    if (marker1 == nullptr || marker2 == nullptr) continue;
    const auto& x1 = marker1->x_in_shape_m[known.corner1];
    const auto& x2 = marker2->x_in_shape_m[known.corner2];
    if (!x1 || !x2) continue;
    checked.back().distance_m = (*x1 - *x2).norm();
    checked.back().sigma_m =
        SigmaOf(covariance, DistanceGradient(*marker1, known.corner1, *marker2, known.corner2));
  }
  return checked;
}

}  // namespace velamap
