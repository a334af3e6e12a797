#include "exporters/surface/surface_terms.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "exporters/shape/shape_sigma.h"
#include "importer/base/ids.h"
#include "importer/base/statistics.h"
#include "importer/geometry/least_squares.h"

namespace velamap {

namespace {

double NominalSigmaOf(const SortedInput& sorted) {
  Eigen::Matrix3Xd places_m(3, static_cast<Eigen::Index>(sorted.by_id.size()));
  Eigen::Index i = 0;
  for (const auto& [id, marker] : sorted.by_id) places_m.col(i++) = marker.x_in_shape_m;
  return NominalSigma(places_m);
}

}  // namespace

MarkerNoise DescribeNoise(const SortedInput& sorted) {
  std::vector<double> known;
  bool some_zero = false;
  for (const auto& [id, marker] : sorted.by_id) {
    const std::optional<double>& sigma = marker.sigma_m;
    if (sigma && *sigma > 0) known.push_back(*sigma);
    some_zero = some_zero || (sigma && *sigma <= 0);
  }
  MarkerNoise noise;
  noise.edge_sigma_m = known.empty() ? NominalSigmaOf(sorted) : Median(known);
  if (some_zero) {
    noise.smoothing = Smoothing::kInterpolate;
  } else if (sorted.by_id.size() < kMinCrossValidated) {
    noise.smoothing = Smoothing::kKnownSigma;
    noise.is_nominal = known.empty();
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
    constexpr double kSeenFactor = 30.0;  // a weight that decides nothing
    const double edge_sigma_m = (observation.is_seen ? kSeenFactor : 1.0) * noise.edge_sigma_m;
    const double sigma_m =
        observation.marker_id < 0 ? edge_sigma_m : noise.sigma_m.at(observation.marker_id);
    const std::size_t n = observation.points.size();
    terms.push_back({k, std::vector<double>(n, 1.0 / n), 1.0 / (sigma_m * sigma_m)});
  }
  return terms;
}

double NormalResidual(const SplineSurface& surface,
                      const std::vector<SurfaceObservation>& observations,
                      const SurfaceTerm& term) {
  const SurfaceObservation& observation = observations[term.observation_idx];
  Eigen::Vector3d residual_m = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < observation.points.size(); ++i) {
    const PlacedPoint& point = observation.points[i];
    residual_m += term.factors[i] * (point.x_in_shape_m - EvaluatePoint(surface, point.u, point.v));
  }
  return EvaluateNormal(surface, observation.u, observation.v).dot(residual_m);
}

void AddTiltTerms(const std::vector<SurfaceObservation>& observations,
                  const std::map<int, double>& tilt_sigma_m, std::vector<SurfaceTerm>* terms) {
  for (std::size_t k = 0; k < observations.size(); ++k) {
    if (observations[k].points.size() != kNumCorners) continue;
    const double sigma_m = tilt_sigma_m.at(observations[k].marker_id);
    const double weight = 1.0 / (sigma_m * sigma_m);
    terms->push_back({k, {0.25, -0.25, -0.25, 0.25}, weight});
    terms->push_back({k, {0.25, 0.25, -0.25, -0.25}, weight});
  }
}

std::map<int, double> TiltSigmas(const std::vector<SurfaceObservation>& observations,
                                 const MarkerNoise& noise, const SmoothSurface& smooth) {
  const CauchyLoss loss{25.0};
  std::vector<SurfaceTerm> tilts;
  AddTiltTerms(observations, noise.tilt_sigma_m, &tilts);
  if (tilts.empty()) return noise.tilt_sigma_m;
  std::vector<double> residuals;
  std::map<int, double> squares;  // of both residuals of a marker
  for (const SurfaceTerm& term : tilts) {
    residuals.push_back(std::sqrt(term.weight) *
                        NormalResidual(smooth.surface, observations, term));
    squares[observations[term.observation_idx].marker_id] += residuals.back() * residuals.back();
  }
  const auto n = static_cast<Eigen::Index>(observations.size());
  const Eigen::VectorXd places = smooth.residuals.head(n);
  const double tilt_noise =
      RobustSigmaAboutZero(residuals, smooth.leverages.tail(smooth.leverages.size() - n).sum());
  const double place_noise =
      RobustSigmaAboutZero({places.begin(), places.end()}, smooth.leverages.head(n).sum());
  // Not below 1, because a surface that is too stiff for exact places does not show that tilts are
  // more accurate.
  const double factor = std::max(tilt_noise / place_noise, 1.0);
  if (!std::isfinite(factor) || tilt_noise <= 0) return noise.tilt_sigma_m;
  std::map<int, double> sigmas_m;
  for (const auto& [id, sigma_m] : noise.tilt_sigma_m) {
    const double in_noise = squares[id] / (tilt_noise * tilt_noise);
    sigmas_m[id] = factor * sigma_m / std::sqrt(loss.Weight(in_noise));
  }
  return sigmas_m;
}

}  // namespace velamap
