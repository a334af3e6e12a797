#include "exporters/surface/surface_terms.h"

#include <algorithm>
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

double NoiseOfTilts(const SmoothSurface& smooth, std::size_t num_places) {
  constexpr double kLargest = 30.0;
  const auto n = static_cast<Eigen::Index>(num_places), num_tilts = smooth.residuals.size() - n;
  if (num_tilts <= 0) return 1.0;
  const auto variance = [](const auto& residuals, const auto& leverages) {
    return residuals.squaredNorm() / (static_cast<double>(residuals.size()) - leverages.sum());
  };
  const double ratio =
      std::sqrt(variance(smooth.residuals.tail(num_tilts), smooth.leverages.tail(num_tilts)) /
                variance(smooth.residuals.head(n), smooth.leverages.head(n)));
  return std::isfinite(ratio) ? std::clamp(ratio, 1 / kLargest, kLargest) : 1.0;
}

}  // namespace velamap
