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
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr std::size_t kMinSurfaceMarkers = 3, kMinLines = 2;
// The first fits are parabolas, whose feet are not moved by noise.
constexpr int kNumParabolicFits = 3, kNumFits = 6;
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

// The sigma of every marker, and the way of smoothing that follows from the sigmas.
struct Noise {
  std::map<int, double> sigma_m;
  double edge_sigma_m = 1.0;
  Smoothing smoothing = Smoothing::kCrossValidation;
};

Noise DescribeNoise(const SortedInput& sorted) {
  std::vector<double> known;
  bool some_zero = false;
  for (const auto& [id, marker] : sorted.by_id) {
    const std::optional<double>& sigma = marker.sigma_m;
    if (sigma && *sigma > 0) known.push_back(*sigma);
    some_zero = some_zero || (sigma && *sigma <= 0);
  }
  Noise noise;
  if (some_zero || (known.empty() && sorted.by_id.size() < kMinCrossValidated)) {
    noise.smoothing = Smoothing::kInterpolate;
  } else if (!known.empty()) {
    if (sorted.by_id.size() < kMinCrossValidated) noise.smoothing = Smoothing::kKnownSigma;
    noise.edge_sigma_m = Median(known);
  }
  for (const auto& [id, marker] : sorted.by_id) {
    noise.sigma_m[id] = noise.smoothing == Smoothing::kInterpolate
                            ? 1.0
                            : marker.sigma_m.value_or(noise.edge_sigma_m);
  }
  return noise;
}

std::vector<double> NoiseWeights(const std::vector<SurfaceObservation>& observations,
                                 const Noise& noise) {
  std::vector<double> weights;
  for (const SurfaceObservation& observation : observations) {
    const double sigma_m =
        observation.marker_id < 0 ? noise.edge_sigma_m : noise.sigma_m.at(observation.marker_id);
    weights.push_back(1.0 / (sigma_m * sigma_m));
  }
  return weights;
}

bool IsInside(const SurfaceFoot& foot) {
  return std::min(foot.u, foot.v) > kInside && std::max(foot.u, foot.v) < 1 - kInside;
}

std::vector<Eigen::Vector3d> Centers(const std::vector<SurfaceMarker>& markers) {
  std::vector<Eigen::Vector3d> centers;
  for (const SurfaceMarker& marker : markers) centers.push_back(marker.x_in_shape_m);
  return centers;
}

void SetSides(const std::map<int, SurfaceMarker>& by_id, SurfaceParameters* parameters) {
  for (SurfaceObservation& observation : parameters->observations) {
    if (observation.marker_id >= 0) observation.side_m = by_id.at(observation.marker_id).side_m;
  }
}

// Adds the markers between the lines at their feet.
void AddBetween(const SortedInput& sorted, const SplineSurface& surface,
                SurfaceParameters* parameters) {
  const std::vector<SurfaceMarker>& markers = sorted.markers;
  const std::vector<SurfaceFoot> feet = ProjectOnSurface(surface, Centers(markers));
  for (std::size_t k = 0; k < feet.size(); ++k) {
    if (!IsInside(feet[k])) continue;
    parameters->observations.push_back(
        {markers[k].marker_id, "", markers[k].x_in_shape_m, feet[k].u, feet[k].v});
  }
  SetSides(sorted.by_id, parameters);
}

std::vector<SurfaceResidual> Residuals(const SortedInput& sorted,
                                       const SurfaceParameters& parameters,
                                       const SplineSurface& surface) {
  std::map<int, const SurfaceObservation*> used;
  for (const SurfaceObservation& observation : parameters.observations) {
    if (observation.marker_id >= 0) used[observation.marker_id] = &observation;
  }
  std::vector<SurfaceMarker> markers;
  for (const auto& [id, marker] : sorted.by_id) {
    markers.push_back(marker);
    const auto observation = used.find(id);
    if (observation != used.end()) markers.back().x_in_shape_m = observation->second->OnCloth();
  }
  const std::vector<SurfaceFoot> feet = ProjectOnSurface(surface, Centers(markers));
  std::vector<SurfaceResidual> residuals;
  for (std::size_t k = 0; k < markers.size(); ++k) {
    const auto observation = used.find(markers[k].marker_id);
    const bool is_used = observation != used.end();
    residuals.push_back({markers[k].marker_id, is_used ? observation->second->line : "", feet[k].u,
                         feet[k].v, feet[k].distance_m, feet[k].beyond_edge_m, is_used});
  }
  return residuals;
}

// Sets what each marker adds to the poles. A point of a given edge errs like the nearest marker.
void AddDependence(const SurfaceParameters& parameters, const SmoothSurface& smooth,
                   FittedSurface* result) {
  const auto& observations = parameters.observations;
  if (smooth.pole_by_observation.size() == 0) return;
  std::vector<const SurfaceObservation*> markers;
  for (const SurfaceObservation& observation : observations) {
    if (observation.marker_id < 0) continue;
    markers.push_back(&observation);
    result->marker_ids.push_back(observation.marker_id);
  }
  result->smoothing_covariance_m2 = smooth.smoothing_covariance_m2;
  result->pole_by_marker = Eigen::MatrixXd::Zero(smooth.pole_by_observation.rows(), markers.size());
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const auto distance_m = [&](const SurfaceObservation* marker) {
      return (marker->x_in_shape_m - observations[k].x_in_shape_m).norm();
    };
    const auto nearest = std::min_element(
        markers.begin(), markers.end(),
        [&](const auto* a, const auto* b) { return distance_m(a) < distance_m(b); });
    result->pole_by_marker.col(nearest - markers.begin()) += smooth.pole_by_observation.col(k);
  }
}

void CheckEdge(const std::vector<Eigen::Vector3d>& edge, const char* name,
               const std::optional<double>& extension_mm, const std::string& extension_option) {
  if (edge.size() == 1) {
    throw InputError(fmt::format("the {} edge has one point; it needs two or more", name));
  }
  if (!edge.empty() && extension_mm.value_or(0.0) > 0) {
    throw InputError(
        fmt::format("{}: the surface cannot go {} mm beyond the {} and end at its given edge; give "
                    "one of the two",
                    extension_option, *extension_mm, name));
  }
}

}  // namespace

OptionGroup DescribeOptions(SurfaceOptions* options) {
  return {"Surface",
          {{"Surface.luff_extension", &options->luff_extension_mm, "mm",
            "how far the surface continues beyond the first markers of the lines; left out: to the "
            "edge that the layout names, or not at all",
            AtLeast(0)},
           {"Surface.leech_extension", &options->leech_extension_mm, "mm",
            "the same beyond the last markers of the lines", AtLeast(0)},
           {"Surface.foot_extension", &options->foot_extension_mm, "mm",
            "the same below the lowest line", AtLeast(0)},
           {"Surface.head_extension", &options->head_extension_mm, "mm",
            "the same above the highest line", AtLeast(0)}}};
}

void SurfaceOptions::Check() const {
  CheckRanges(*this);
  CheckEdge(edges.luff, "luff", luff_extension_mm, OptionName(&SurfaceOptions::luff_extension_mm));
  CheckEdge(edges.leech, "leech", leech_extension_mm,
            OptionName(&SurfaceOptions::leech_extension_mm));
  CheckEdge(edges.foot, "foot", foot_extension_mm, OptionName(&SurfaceOptions::foot_extension_mm));
  CheckEdge(edges.head, "head", head_extension_mm, OptionName(&SurfaceOptions::head_extension_mm));
}

std::optional<double> SigmaAt(const FittedSurface& fit, double u, double v) {
  return SigmaAt(fit.surface, fit.pole_covariance_m2, u, v);
}

std::optional<SurfaceDependence> DependenceAt(const FittedSurface& fit, double u, double v) {
  if (fit.pole_by_marker.size() == 0) return std::nullopt;
  SurfaceDependence dependence;
  dependence.marker_weights = (PoleShares(fit.surface, u, v) * fit.pole_by_marker).transpose();
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
  const Noise noise = DescribeNoise(sorted);
  SurfaceParameters parameters = AssignParameters(sorted.lines, !sorted.markers.empty(), ends);
  const OpenSides open = OpenSidesOf(parameters, ends.edges);
  SetSides(sorted.by_id, &parameters);
  // An interpolating surface keeps the chord lengths, which make the fairest curves through points.
  const bool interpolates = noise.smoothing == Smoothing::kInterpolate;
  SmoothSurface smooth;
  for (int fit = 1; fit <= kNumFits; ++fit) {
    const bool is_parabolic = fit <= kNumParabolicFits && !interpolates;
    smooth = SmoothObservations(parameters, NoiseWeights(parameters.observations, noise),
                                is_parabolic ? Smoothing::kParabolas : noise.smoothing);
    if (fit == kNumParabolicFits) AddBetween(sorted, smooth.surface, &parameters);
    if (fit == kNumFits) break;
    if (interpolates) {
      MoveMarkersBetweenLinesToFeet(smooth.surface, &parameters);
    } else {
      MoveToFeet(smooth.surface, open, &parameters);
    }
    SetSags(smooth.surface, &parameters);
  }
  CheckArea(sorted, ends, smooth.surface);
  FittedSurface result;
  result.surface = smooth.surface;
  result.pole_covariance_m2 = smooth.pole_covariance_m2;
  result.num_effective_parameters = smooth.num_effective_parameters;
  AddDependence(parameters, smooth, &result);
  result.residuals = Residuals(sorted, parameters, smooth.surface);
  result.notes = sorted.notes;
  result.notes.insert(result.notes.end(), parameters.notes.begin(), parameters.notes.end());
  result.edges = EdgesOf(smooth);
  NoteEdges(sorted, ends, result.edges, &result.notes);
  std::vector<double> distances_m;
  std::vector<int> outside;
  for (const SurfaceResidual& residual : result.residuals) {
    if (residual.is_used) {
      distances_m.push_back(residual.distance_m);
    } else {
      outside.push_back(residual.marker_id);
    }
  }
  result.distance_m = ComputeStatistics(distances_m);
  if (!outside.empty()) {
    result.notes.push_back(fmt::format("markers outside the edge of the surface, not used: {}",
                                       fmt::join(outside, " ")));
  }
  return result;
}

}  // namespace velamap
