#include "exporters/surface/surface.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "exporters/surface/surface_area.h"
#include "exporters/surface/surface_ends.h"
#include "exporters/surface/surface_feet.h"
#include "exporters/surface/surface_parameters.h"
#include "exporters/surface/surface_smoother.h"
#include "exporters/surface/surface_terms.h"
#include "exporters/surface/surface_trim.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr std::size_t kMinSurfaceMarkers = 3, kMinLines = 2;
// The first fits are parabolas, whose feet are not moved by noise. The next one leaves out the
// tilts, so that tilts which contradict the places, as those of stiff plates do, get little weight.
constexpr int kNumParabolicFits = 3, kNumFits = 7;
// A foot within this parameter distance of an edge counts as a foot on the edge.
constexpr double kInside = 1e-9;

SortedInput SortInput(const SurfaceInput& input) {
  SortedInput sorted;
  sorted.markers = input.markers;
  for (const SurfaceMarker& marker : input.markers) sorted.by_id[marker.marker_id] = marker;
  for (const SurfaceLine& line : input.lines) {
    std::vector<SurfaceMarker> present;
    for (const auto& marker : line.markers) {
      if (!marker) continue;
      present.push_back(*marker);
      sorted.by_id[marker->marker_id] = *marker;
    }
    if (present.size() >= kMinSurfaceMarkers) {
      sorted.lines.push_back(line);
      continue;
    }
    sorted.markers.insert(sorted.markers.end(), present.begin(), present.end());
    sorted.notes.push_back(fmt::format("line {}: {} of its {} markers whole, {} needed; left out",
                                       line.name, present.size(), line.markers.size(),
                                       kMinSurfaceMarkers));
  }
  if (sorted.lines.size() < kMinLines) {
    throw DataError(fmt::format("{} of {} horizontal lines have {} whole markers, {} needed{}{}",
                                sorted.lines.size(), input.lines.size(), kMinSurfaceMarkers,
                                kMinLines, sorted.notes.empty() ? "" : ": ",
                                fmt::join(sorted.notes, "; ")));
  }
  return sorted;
}

bool IsInside(const SurfaceFoot& foot) {
  return std::min(foot.u, foot.v) > kInside && std::max(foot.u, foot.v) < 1 - kInside;
}

std::vector<Eigen::Vector3d> Centers(const std::vector<SurfaceMarker>& markers) {
  std::vector<Eigen::Vector3d> centers;
  for (const SurfaceMarker& marker : markers) centers.push_back(marker.x_in_shape_m);
  return centers;
}

// The corners start at the place of their marker.
void SetCorners(const std::map<int, SurfaceMarker>& by_id, SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.marker_id < 0 || observation.points.size() > 1) continue;
    const auto& corners_m = by_id.at(observation.marker_id).corners_in_shape_m;
    if (corners_m.empty()) continue;
    observation.points.clear();
    for (const Eigen::Vector3d& x : corners_m) {
      observation.points.push_back({x, observation.u, observation.v});
    }
  }
}

// Adds the markers between the lines at their feet.
void AddBetween(const SortedInput& sorted, const SplineSurface& surface,
                SurfaceParameters* parameters) {
  const std::vector<SurfaceMarker>& markers = sorted.markers;
  const std::vector<SurfaceFoot> feet = ProjectOnSurface(surface, Centers(markers));
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (!IsInside(feet[k])) continue;
    const double u = feet[k].u, v = feet[k].v;
    parameters->observations.push_back(
        {markers[k].marker_id, "", u, v, {{markers[k].x_in_shape_m, u, v}}});
  }
  SetCorners(sorted.by_id, parameters);
}

std::vector<SurfaceResidual> Residuals(const SortedInput& sorted,
                                       const SurfaceParameters& parameters,
                                       const std::vector<SurfaceTerm>& terms,
                                       const SplineSurface& surface) {
  const auto& observations = parameters.observations;
  std::map<int, std::size_t> used;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    if (observations[k].marker_id >= 0) used[observations[k].marker_id] = k;
  }
  std::vector<SurfaceMarker> markers;
  for (const auto& [id, marker] : sorted.by_id) markers.push_back(marker);
  const std::vector<SurfaceFoot> feet = ProjectOnSurface(surface, Centers(markers));
  std::vector<SurfaceResidual> residuals;
  for (std::size_t k = 0; k < markers.size(); ++k) {
    residuals.push_back({markers[k].marker_id, "", feet[k].u, feet[k].v, feet[k].distance_m,
                         feet[k].beyond_edge_m, false, 0.0});
    const auto observation = used.find(markers[k].marker_id);
    if (observation == used.end()) continue;
    residuals.back().line = observations[observation->second].line;
    residuals.back().distance_m = NormalResidual(surface, observations, terms[observation->second]);
    residuals.back().is_used = true;
    residuals.back().bend_m = residuals.back().distance_m - feet[k].distance_m;
  }
  return residuals;
}

// Sets how the poles depend on each point of a marker. A point of a given edge is taken to have the
// error of the nearest marker.
void AddDependence(const SurfaceParameters& parameters, const std::vector<SurfaceTerm>& terms,
                   const SmoothSurface& smooth, FittedSurface* result) {
  const auto& observations = parameters.observations;
  if (smooth.pole_by_term.size() == 0) return;
  std::vector<std::size_t> markers;
  std::map<std::size_t, Eigen::Index> first_point;  // by marker
  for (std::size_t k = 0; k < observations.size(); ++k) {
    if (observations[k].marker_id < 0) continue;
    markers.push_back(k);
    first_point[k] = static_cast<Eigen::Index>(result->points.size());
    const int num_points = static_cast<int>(observations[k].points.size());
    for (int i = 0; i < num_points; ++i) {
      result->points.push_back({observations[k].marker_id, num_points == 1 ? 0 : i + 1});
    }
  }
  result->smoothing_covariance_m2 = smooth.smoothing_covariance_m2;
  result->pole_by_point = Eigen::MatrixXd::Zero(smooth.pole_by_term.rows(), result->points.size());
  for (std::size_t t = 0; t < terms.size(); ++t) {
    std::size_t marker = terms[t].observation_idx;
    std::vector<double> factors = terms[t].factors;
    if (observations[marker].marker_id < 0) {
      const auto distance_m = [&, x = observations[marker].Center()](std::size_t k) {
        return (observations[k].Center() - x).norm();
      };
      marker = *std::min_element(markers.begin(), markers.end(), [&](std::size_t a, std::size_t b) {
        return distance_m(a) < distance_m(b);
      });
      const std::size_t n = observations[marker].points.size();
      factors.assign(n, 1.0 / n);
    }
    for (std::size_t i = 0; i < factors.size(); ++i) {
      result->pole_by_point.col(first_point[marker] + static_cast<Eigen::Index>(i)) +=
          factors[i] * smooth.pole_by_term.col(static_cast<Eigen::Index>(t));
    }
  }
}

// Sets the statistics of the used markers and notes the others.
void SummarizeResiduals(FittedSurface* result) {
  std::vector<double> distances_m;
  std::vector<int> outside;
  for (const SurfaceResidual& residual : result->residuals) {
    if (residual.is_used) {
      distances_m.push_back(residual.distance_m);
    } else {
      outside.push_back(residual.marker_id);
    }
  }
  result->distance_m = ComputeStatistics(distances_m);
  if (!outside.empty()) {
    result->notes.push_back(fmt::format("markers outside the edge of the surface, not used: {}",
                                        fmt::join(outside, " ")));
  }
}

bool HasTilts(const SortedInput& sorted) {
  return std::any_of(sorted.by_id.begin(), sorted.by_id.end(),
                     [](const auto& entry) { return !entry.second.corners_in_shape_m.empty(); });
}

struct SurfaceFit {
  SmoothSurface smooth;
  std::vector<SurfaceTerm> terms;
};

// Fits again and again, and moves the parameters of the markers to their feet in between.
SurfaceFit IterateFits(const SortedInput& sorted, const MarkerNoise& noise,
                       SurfaceParameters* parameters) {
  const bool interpolates = noise.smoothing == Smoothing::kInterpolate;
  SurfaceFit result;
  auto& [smooth, terms] = result;
  std::optional<std::map<int, double>> tilt_sigma_m;
  std::optional<SmoothingWeights> weights;  // of the last fit with all terms
  for (int fit = 1; fit <= kNumFits; ++fit) {
    const bool is_parabolic = fit <= kNumParabolicFits;
    terms = PlaceTerms(parameters->observations, noise);
    if (tilt_sigma_m) AddTiltTerms(parameters->observations, *tilt_sigma_m, &terms);
    smooth = SmoothTerms(*parameters, terms, is_parabolic ? Smoothing::kParabolas : noise.smoothing,
                         weights);
    if (tilt_sigma_m) weights = smooth.weights;
    if (fit == kNumFits) break;
    if (fit == kNumParabolicFits) AddBetween(sorted, smooth.surface, parameters);
    if (!interpolates) {
      if (!is_parabolic) tilt_sigma_m = TiltSigmas(parameters->observations, noise, smooth);
      MoveMarkersToFeet(smooth.surface, parameters);
    } else if (is_parabolic) {
      MoveCornersAroundMarkers(smooth.surface, parameters);
    } else {
      MoveMarkersBetweenLinesToFeet(smooth.surface, parameters);
    }
  }
  return result;
}

FittedSurface MakeResult(const SortedInput& sorted, const SurfaceOptions& ends,
                         const SurfaceParameters& parameters, const SurfaceFit& fit) {
  const auto& [smooth, terms] = fit;
  FittedSurface result;
  result.surface = smooth.surface;
  result.pole_covariance_m2 = smooth.pole_covariance_m2;
  result.num_effective_parameters = smooth.num_effective_parameters;
  AddDependence(parameters, terms, smooth, &result);
  result.residuals = Residuals(sorted, parameters, terms, smooth.surface);
  result.notes = sorted.notes;
  result.notes.insert(result.notes.end(), parameters.notes.begin(), parameters.notes.end());
  result.edges = EdgesOf(smooth);
  NoteEdges(sorted, ends, result.edges, &result.notes);
  SummarizeResiduals(&result);
  return result;
}

}  // namespace

std::optional<double> SigmaAt(const FittedSurface& fit, double u, double v) {
  return SigmaAt(fit.surface, fit.pole_covariance_m2, u, v);
}

std::optional<SurfaceDependence> DependenceAt(const FittedSurface& fit, double u, double v) {
  if (fit.pole_by_point.size() == 0) return std::nullopt;
  SurfaceDependence dependence;
  dependence.point_weights = (PoleShares(fit.surface, u, v) * fit.pole_by_point).transpose();
  const auto variance_m2 = [&](const Eigen::MatrixXd& pole_covariance_m2) {
    return std::pow(SigmaAt(fit.surface, pole_covariance_m2, u, v).value_or(0.0), 2);
  };
  const double both_m2 = variance_m2(fit.pole_covariance_m2);
  dependence.smoothing_variance_m2 = std::min(both_m2, variance_m2(fit.smoothing_covariance_m2));
  dependence.noise_variance_m2 = both_m2 - dependence.smoothing_variance_m2;
  return dependence;
}

bool FacesLikeMarkers(const FittedSurface& fit, const MarkerShape& shape) {
  double agreement = 0.0;
  for (const SurfaceResidual& marker : fit.residuals) {
    agreement += EvaluateNormal(fit.surface, marker.u, marker.v)
                     .dot(MarkerNormal(*FindWholeMarker(shape, marker.marker_id)));
  }
  return agreement >= 0;
}

FittedSurface FitSurface(const SurfaceInput& input, const SurfaceOptions& options) {
  options.Check();
  SortedInput sorted = SortInput(input);
  const SurfaceOptions ends = WithEdgesOf(input, options, &sorted);
  const MarkerNoise noise = DescribeNoise(sorted);
  // An interpolating surface keeps the chord lengths, which make the fairest curves through points.
  const bool interpolates = noise.smoothing == Smoothing::kInterpolate;
  const bool shows_between = !sorted.markers.empty() || (!interpolates && HasTilts(sorted));
  SurfaceParameters parameters = AssignParameters(sorted.lines, shows_between, ends);
  // One that interpolates has the edge where the lines end; points between them would bend it.
  if (!interpolates) AddEdgePoints(ends.edges, &parameters);
  SetCorners(sorted.by_id, &parameters);
  SurfaceFit fit = IterateFits(sorted, noise, &parameters);
  // An interpolating surface has its ends at u and v of 0 and 1, because its markers stay there.
  if (!interpolates) {
    TrimToOutline(OutlineOf(fit.smooth.surface, parameters), &parameters, &fit.smooth);
  }
  if (noise.is_nominal) {
    fit.smooth.pole_covariance_m2.resize(0, 0);
    fit.smooth.pole_by_term.resize(0, 0);
  }
  CheckArea(sorted, ends, fit.smooth.surface);
  return MakeResult(sorted, ends, parameters, fit);
}

}  // namespace velamap
