#include "reconstruct/global/map_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

// Medians of chi-square with 8 and 2 degrees of freedom: of the corners of a marker at a known
// place, and of their residuals after a fit of its pose.
constexpr double kMedianOf8 = 7.344, kMedianOf2 = 1.386;
// The nominal sigma is a guess; the noise of corners is not taken to be below this part of it.
constexpr double kMinFactor = 0.3;

// Converts a median RMS error of four corners to 1 sigma of a coordinate.
double SigmaFromMedian(double median_rms, double median_of_chi_square) {
  return median_rms * std::sqrt(kNumCorners / median_of_chi_square);
}

std::string Px(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), value < 10 ? "%.1f px" : "%.0f px", value);
  return text.data();
}

// Distances of the corners from their projections, px.
std::array<double, kNumCorners> CornerErrors(const MapProblem& problem, const MapSolution& solution,
                                             const MapObservation& observation) {
  const Rigid3& pose = *solution.cam_from_shape[static_cast<std::size_t>(observation.frame_idx)];
  const auto corners = CornersInShape(
      problem.Marker(observation.marker_idx),
      solution.shape_from_marker[static_cast<std::size_t>(observation.marker_idx)].front());
  std::array<double, kNumCorners> errors_px{};
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    errors_px[i] =
        (observation.px_from_ray[i] * ((pose * corners[i]).hnormalized() - observation.rays[i]))
            .norm();
  }
  return errors_px;
}

}  // namespace

MapNoise EstimateNoise(const MapProblem& problem, const MapSolution& solution) {
  MapNoise noise;
  noise.factor_of_frame.assign(problem.frames.size(), 0.0);
  std::vector<double> relative, errors_px, alone_px;
  std::vector<std::vector<double>> relative_of_frame(problem.frames.size());
  for (std::size_t idx = 0; idx < problem.observations.size(); ++idx) {
    if (!solution.fits[idx]) continue;
    const MapObservation& observation = problem.observations[idx];
    const double error_px = ReprojectionError(problem, solution, observation);
    relative.push_back(error_px / observation.sigma_px);
    errors_px.push_back(error_px);
    alone_px.push_back(observation.alone_error_px);
    relative_of_frame[static_cast<std::size_t>(observation.frame_idx)].push_back(relative.back());
  }
  if (relative.empty()) return noise;
  noise.factor = SigmaFromMedian(Median(std::move(relative)), kMedianOf8);
  noise.sigma_px = SigmaFromMedian(Median(std::move(errors_px)), kMedianOf8);
  noise.alone_sigma_px = SigmaFromMedian(Median(std::move(alone_px)), kMedianOf2);
  for (std::size_t idx = 0; idx < problem.frames.size(); ++idx) {
    if (relative_of_frame[idx].empty()) continue;
    noise.factor_of_frame[idx] =
        SigmaFromMedian(Median(std::move(relative_of_frame[idx])), kMedianOf8);
  }
  return noise;
}

double FinalTolerance(const MapObservation& observation, const MapNoise& noise) {
  // The RMS distance of four corners is 1.4 sigma of a coordinate; 5 sigma is 3.5 times that, which
  // no good observation reaches.
  constexpr double kSigmas = 5.0;
  const double factor = std::max(
      {noise.factor, noise.factor_of_frame[static_cast<std::size_t>(observation.frame_idx)],
       kMinFactor});
  return kSigmas * factor * observation.sigma_px;
}

void MarkFinalFits(const MapProblem& problem, const MapNoise& noise, MapSolution* solution) {
  for (std::size_t idx = 0; idx < problem.observations.size(); ++idx) {
    const MapObservation& observation = problem.observations[idx];
    solution->fits[idx] =
        ReprojectionError(problem, *solution, observation) <= FinalTolerance(observation, noise);
  }
}

bool IsSuspicious(const MapNoise& noise) {
  // The errors of a right shape are within twice the noise of the corners, lens and cloth included.
  constexpr double kRatio = 4.0, kNegligiblePx = 0.25;
  return noise.sigma_px > kNegligiblePx && noise.sigma_px > kRatio * noise.alone_sigma_px;
}

std::string WhyOutlier(const MapProblem& problem, const MapSolution& solution,
                       const MapNoise& noise, const MapObservation& observation) {
  const double tolerance_px =
      std::max(FinalTolerance(observation, noise), GrowthTolerance(observation));
  const Rigid3& pose = *solution.cam_from_shape[static_cast<std::size_t>(observation.frame_idx)];
  const std::size_t marker_idx = static_cast<std::size_t>(observation.marker_idx);
  for (std::size_t other_idx = 0; other_idx < problem.markers.size(); ++other_idx) {
    if (other_idx == marker_idx || solution.shape_from_marker[other_idx].empty()) continue;
    MapObservation as_other = observation;
    as_other.marker_idx = static_cast<int>(other_idx);
    if (ReprojectionError(problem, as_other, pose, solution.shape_from_marker[other_idx].front()) <=
        tolerance_px) {
      return "wrong id: marker " + std::to_string(problem.markers[other_idx].marker_id) +
             " stands there";
    }
  }
  MapObservation turned = observation;
  for (int quarters = 1; quarters < kNumCorners; ++quarters) {
    std::rotate(turned.rays.begin(), turned.rays.begin() + 1, turned.rays.end());
    std::rotate(turned.px_from_ray.begin(), turned.px_from_ray.begin() + 1,
                turned.px_from_ray.end());
    if (ReprojectionError(problem, turned, pose, solution.shape_from_marker[marker_idx].front()) <=
        tolerance_px) {
      return "corners numbered from the wrong one, turned by " + std::to_string(90 * quarters) +
             " degrees";
    }
  }
  const auto errors_px = CornerErrors(problem, solution, observation);
  const double corner_tolerance_px = FinalTolerance(observation, noise);
  std::string corners;
  int num_off = 0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    if (errors_px[i] <= corner_tolerance_px) continue;
    ++num_off;
    corners += (corners.empty() ? "corner " : ", ") + std::to_string(i + 1) + " off by " +
               Px(errors_px[i]);
  }
  if (num_off > 0 && num_off < kNumCorners) return corners;
  return Px(ReprojectionError(problem, solution, observation)) + " from its place";
}

}  // namespace velamap
