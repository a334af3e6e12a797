#include "exporters/surface/surface_terms.h"

#include <cmath>
#include <optional>

#include "importer/base/ids.h"
#include "importer/base/statistics.h"

namespace velamap {

MarkerNoise DescribeNoise(const SortedInput& sorted) {
  std::vector<double> known;
  bool some_zero = false;
  for (const auto& [id, marker] : sorted.by_id) {
    const std::optional<double>& sigma = marker.sigma_m;
    if (sigma && *sigma > 0) known.push_back(*sigma);
    some_zero = some_zero || (sigma && *sigma <= 0);
  }
  MarkerNoise noise;
  if (some_zero || (known.empty() && sorted.by_id.size() < kMinCrossValidated)) {
    noise.smoothing = Smoothing::kInterpolate;
  } else if (!known.empty()) {
    if (sorted.by_id.size() < kMinCrossValidated) noise.smoothing = Smoothing::kKnownSigma;
    noise.edge_sigma_m = Median(known);
  }
  for (const auto& [id, marker] : sorted.by_id) {
    const double sigma_m = noise.smoothing == Smoothing::kInterpolate
                               ? 1.0
                               : marker.sigma_m.value_or(noise.edge_sigma_m);
    noise.sigma_m[id] = sigma_m;
    noise.tilt_sigma_m[id] = marker.tilt_sigma_m.value_or(sigma_m);
  }
  return noise;
}

std::vector<SurfaceTerm> PlaceTerms(const std::vector<SurfaceObservation>& observations,
                                    const MarkerNoise& noise) {
  std::vector<SurfaceTerm> terms;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const SurfaceObservation& observation = observations[k];
    const double sigma_m =
        observation.marker_id < 0 ? noise.edge_sigma_m : noise.sigma_m.at(observation.marker_id);
    const std::size_t n = observation.points.size();
    terms.push_back({k, std::vector<double>(n, 1.0 / n), 1.0 / (sigma_m * sigma_m)});
  }
  return terms;
}

void AddTiltTerms(const std::vector<SurfaceObservation>& observations, const MarkerNoise& noise,
                  double noise_factor, std::vector<SurfaceTerm>* terms) {
  for (std::size_t k = 0; k < observations.size(); ++k) {
    if (observations[k].points.size() != kNumCorners) continue;
    const double sigma_m = noise_factor * noise.tilt_sigma_m.at(observations[k].marker_id);
    const double weight = 1.0 / (sigma_m * sigma_m);
    terms->push_back({k, {0.25, -0.25, -0.25, 0.25}, weight});
    terms->push_back({k, {0.25, 0.25, -0.25, -0.25}, weight});
  }
}

double NoiseOfTilts(const std::vector<SurfaceObservation>& observations, const MarkerNoise& noise,
                    const SmoothSurface& smooth) {
  std::vector<SurfaceTerm> tilts;
  AddTiltTerms(observations, noise, 1.0, &tilts);
  double squares_of_tilts = 0.0;
  for (const SurfaceTerm& term : tilts) {
    const SurfaceObservation& marker = observations[term.observation_idx];
    Eigen::Vector3d residual_m = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < marker.points.size(); ++i) {
      const PlacedPoint& point = marker.points[i];
      residual_m +=
          term.factors[i] * (point.x_in_shape_m - EvaluatePoint(smooth.surface, point.u, point.v));
    }
    const Eigen::Vector3d normal = EvaluateNormal(smooth.surface, marker.u, marker.v);
    squares_of_tilts += term.weight * std::pow(normal.dot(residual_m), 2);
  }
  const auto n = static_cast<Eigen::Index>(observations.size());
  const double free_tilts =
      static_cast<double>(tilts.size()) - smooth.leverages.tail(smooth.leverages.size() - n).sum();
  const double free_places = static_cast<double>(n) - smooth.leverages.head(n).sum();
  const double ratio = std::sqrt(squares_of_tilts / free_tilts /
                                 (smooth.residuals.head(n).squaredNorm() / free_places));
  return std::isfinite(ratio) && ratio > 0 ? ratio : 1.0;
}

}  // namespace velamap
