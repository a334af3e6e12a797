#include "exporters/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "exporters/surface/surface_ends.h"
#include "exporters/surface/surface_feet.h"
#include "exporters/surface/surface_parameters.h"
#include "exporters/surface/surface_rows.h"
#include "exporters/surface/surface_smoother.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr std::size_t kMinSurfaceMarkers = 3, kMinLines = 2;
// Limits of the surface's area over that of straight strips between the lines. A half cylinder has
// a ratio of 1.57.
constexpr double kMaxAreaRatio = 1.6, kMaxAreaRatioWithEdges = 4.0;
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

Noise DescribeNoise(const SortedInput& sorted, const SurfaceOptions& options) {
  std::vector<double> known;
  bool some_zero = false;
  for (const auto& [id, marker] : sorted.by_id) {
    const std::optional<double> sigma = marker.sigma_m ? marker.sigma_m : options.default_sigma_m;
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
    const std::optional<double> sigma = marker.sigma_m ? marker.sigma_m : options.default_sigma_m;
    noise.sigma_m[id] =
        noise.smoothing == Smoothing::kInterpolate ? 1.0 : sigma.value_or(noise.edge_sigma_m);
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

// The point of a polyline at a fraction of its length.
Eigen::Vector3d PointAtFraction(const std::vector<Eigen::Vector3d>& points, double fraction) {
  const std::vector<double> lengths_m = ChordLengths(points);
  const double wanted_m = fraction * lengths_m.back();
  std::size_t i = 1;
  while (i + 1 < points.size() && lengths_m[i] < wanted_m) ++i;
  const double part = (wanted_m - lengths_m[i - 1]) / (lengths_m[i] - lengths_m[i - 1]);
  return points[i - 1] + part * (points[i] - points[i - 1]);
}

// Area of straight strips from line to line.
double RuledArea(const std::vector<SurfaceLine>& lines) {
  constexpr int kNumStrips = 50;
  std::vector<std::vector<Eigen::Vector3d>> polylines;
  for (const SurfaceLine& line : lines) {
    polylines.emplace_back();
    for (const auto& marker : line.markers) {
      if (marker) polylines.back().push_back(marker->x_in_shape_m);
    }
  }
  double area_m2 = 0.0;
  for (std::size_t j = 1; j < polylines.size(); ++j) {
    for (int i = 0; i < kNumStrips; ++i) {
      const double from = i / static_cast<double>(kNumStrips);
      const double to = (i + 1) / static_cast<double>(kNumStrips);
      const Eigen::Vector3d a = PointAtFraction(polylines[j - 1], from),
                            b = PointAtFraction(polylines[j - 1], to);
      const Eigen::Vector3d c = PointAtFraction(polylines[j], to),
                            d = PointAtFraction(polylines[j], from);
      area_m2 += (c - a).cross(d - b).norm() / 2;
    }
  }
  return area_m2;
}

// Rejects a surface that oscillates between its markers, as one through scattered points does.
void CheckArea(const SortedInput& sorted, const SurfaceOptions& options,
               const SplineSurface& surface) {
  const SurfaceEdges& edges = options.edges;
  bool is_extended = false;
  for (const auto& extension_mm : {options.luff_extension_mm, options.leech_extension_mm,
                                   options.foot_extension_mm, options.head_extension_mm}) {
    is_extended = is_extended || extension_mm.value_or(0.0) > 0;
  }
  for (const SurfaceLine& line : sorted.lines) {
    is_extended = is_extended || line.luff_offset_m.value_or(0.0) > 0 ||
                  line.leech_offset_m.value_or(0.0) > 0;
  }
  const bool has_edges =
      !edges.luff.empty() || !edges.leech.empty() || !edges.foot.empty() || !edges.head.empty();
  const double max_ratio = is_extended || has_edges ? kMaxAreaRatioWithEdges : kMaxAreaRatio;
  const double area_m2 = SurfaceArea(surface), ruled_area_m2 = RuledArea(sorted.lines);
  if (area_m2 <= max_ratio * ruled_area_m2) return;
  throw DataError(fmt::format(
      "the surface would oscillate between the markers ({:.3g} m2 instead of about {:.3g} m2); "
      "check the errors of the markers and the order of the lines{}",
      area_m2, ruled_area_m2, is_extended ? ", or extend the surface by less" : ""));
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
  if (default_sigma_m && !(*default_sigma_m >= 0 && std::isfinite(*default_sigma_m))) {
    throw InputError(
        fmt::format("the default sigma of the surface is {} m; it must be 0 (interpolate) or more",
                    *default_sigma_m));
  }
  CheckEdge(edges.luff, "luff", luff_extension_mm, OptionName(&SurfaceOptions::luff_extension_mm));
  CheckEdge(edges.leech, "leech", leech_extension_mm,
            OptionName(&SurfaceOptions::leech_extension_mm));
  CheckEdge(edges.foot, "foot", foot_extension_mm, OptionName(&SurfaceOptions::foot_extension_mm));
  CheckEdge(edges.head, "head", head_extension_mm, OptionName(&SurfaceOptions::head_extension_mm));
}

std::optional<double> SigmaAt(const FittedSurface& fit, double u, double v) {
  return SigmaAt(fit.surface, fit.pole_covariance_m2, u, v);
}

FittedSurface FitSurface(const SurfaceInput& input, const SurfaceOptions& options) {
  options.Check();
  SortedInput sorted = SortInput(input);
  const SurfaceOptions ends = WithEdgesOf(input, options, &sorted);
  const Noise noise = DescribeNoise(sorted, options);
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
      MoveBetweenToFeet(smooth.surface, &parameters);
    } else {
      MoveToFeet(smooth.surface, open, &parameters);
    }
    AddSag(smooth.surface, &parameters);
  }
  CheckArea(sorted, ends, smooth.surface);
  FittedSurface result;
  result.surface = smooth.surface;
  result.pole_covariance_m2 = smooth.pole_covariance_m2;
  result.num_effective_parameters = smooth.num_effective_parameters;
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
