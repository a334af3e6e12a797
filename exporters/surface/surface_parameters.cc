#include "exporters/surface/surface_parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "exporters/surface/surface_rows.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr int kMaxSpans = 20;  // in each direction; no sail has more markers on a line

constexpr char kLengthOfLines[] = "the length of the lines";
constexpr char kSpanOfLines[] = "the distance from the lowest to the highest line";

Eigen::ArrayXd ClampedKnots(int degree, const std::vector<double>& interior) {
  const Eigen::Index n = static_cast<Eigen::Index>(interior.size());
  Eigen::ArrayXd knots = Eigen::ArrayXd::Zero(n + 2 * (degree + 1));
  for (Eigen::Index k = 0; k < n; ++k) knots(degree + 1 + k) = interior[k];
  knots.tail(degree + 1).setOnes();
  return knots;
}

// Interior knots at quantiles of the parameters, so that every span holds data.
std::vector<double> QuantileKnots(std::vector<double> parameters, int num_spans) {
  std::sort(parameters.begin(), parameters.end());
  std::vector<double> knots;
  for (int k = 1; k < num_spans; ++k) {
    const double place = static_cast<double>(k) / num_spans * (parameters.size() - 1);
    const std::size_t below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, parameters.size() - 1);
    const double knot =
        parameters[below] + (place - below) * (parameters[above] - parameters[below]);
    // Closer knots would add poles that the markers do not determine.
    const double previous = knots.empty() ? 0.0 : knots.back();
    const double min_span = 0.2 / num_spans;
    if (knot - previous > min_span && 1.0 - knot > min_span) knots.push_back(knot);
  }
  return knots;
}

// A surface that is extrapolated by more than its own size has a shape that no marker determines,
// and its equations lose their rank in double precision.
void CheckExtension(const SurfaceOptions& options,
                    std::optional<double> SurfaceOptions::*extension_mm, double size_m,
                    const char* size_name) {
  const double max_mm = size_m / kMPerMm;
  if ((options.*extension_mm).value_or(0.0) <= max_mm) return;
  throw InputError(fmt::format("{}: {:g} mm, expected at most {:.0f} mm, {}",
                               OptionName(extension_mm), *(options.*extension_mm),
                               std::floor(max_mm), size_name));
}

// Whether the point of a row, which is not a marker, lies on an edge with `is_seen`.
bool IsSeen(const SurfaceEdges& edges, const std::vector<SurfaceRow>& rows, std::size_t row,
            std::size_t point) {
  if (rows[row].is_edge) return row == 0 ? edges.foot.is_seen : edges.head.is_seen;
  return point == 0 ? edges.luff.is_seen : edges.leech.is_seen;
}

// Whether luff and leech are given, or offset from the lines.
void SetKnownSides(const std::vector<SurfaceLine>& lines, const SurfaceOptions& options,
                   SurfaceParameters* parameters) {
  const auto has = [&](std::optional<double> SurfaceLine::*offset_m) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](const SurfaceLine& line) { return (line.*offset_m).has_value(); });
  };
  parameters->luff.is_known = !options.edges.luff.points_m.empty() || options.luff_extension_mm ||
                              has(&SurfaceLine::luff_offset_m);
  parameters->leech.is_known = !options.edges.leech.points_m.empty() ||
                               options.leech_extension_mm || has(&SurfaceLine::leech_offset_m);
}

// The place of a point of an edge, by the ends of the rows beside it.
Eigen::Vector2d PlaceBeside(const std::vector<SurfaceObservation>& ends, const Eigen::Vector3d& x) {
  double least_m = std::numeric_limits<double>::infinity();
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  for (std::size_t k = 1; k < ends.size(); ++k) {
    const SurfaceObservation &low = ends[k - 1], &high = ends[k];
    const Eigen::Vector3d along_m = high.Center() - low.Center();
    double part = along_m.dot(x - low.Center()) / along_m.squaredNorm();
    if (k > 1) part = std::max(part, 0.0);
    if (k + 1 < ends.size()) part = std::min(part, 1.0);
    const double distance_m = (low.Center() + part * along_m - x).norm();
    if (!(distance_m < least_m)) continue;
    least_m = distance_m;
    place = {low.u + part * (high.u - low.u), low.v + part * (high.v - low.v)};
  }
  return place;
}

void AddPointsOf(const SurfaceEdge& given, std::size_t ObservedRow::*end_idx, ObservedEdge* edge,
                 SurfaceParameters* parameters) {
  constexpr double kSamePlace_m = 1e-6;
  std::vector<SurfaceObservation> ends;
  for (const ObservedRow& row : parameters->rows) {
    ends.push_back(parameters->observations[row.*end_idx]);
  }
  edge->first_idx = parameters->observations.size();
  edge->beyond_m = given.beyond_m;
  for (const Eigen::Vector3d& x : SomePoints(given.points_m)) {
    const bool is_end = std::any_of(ends.begin(), ends.end(), [&](const SurfaceObservation& end) {
      return (end.Center() - x).norm() < kSamePlace_m;
    });
    if (is_end) continue;
    const Eigen::Vector2d uv = PlaceBeside(ends, x);
    parameters->observations.push_back({-1, "", uv[0], uv[1], {{x, uv[0], uv[1]}}, given.is_seen});
  }
  edge->num_points = parameters->observations.size() - edge->first_idx;
}

// Returns v of each row, by the mean distances between the rows. Sets the lengths across them.
std::vector<double> PlaceRows(const std::vector<SurfaceRow>& rows, const SurfaceOptions& options,
                              SurfaceParameters* parameters) {
  const SurfaceEdges& edges = options.edges;
  parameters->below_m = edges.foot.beyond_m + kMPerMm * options.foot_extension_mm.value_or(0.0);
  parameters->above_m = edges.head.beyond_m + kMPerMm * options.head_extension_mm.value_or(0.0);
  std::vector<double> heights_m = {parameters->below_m};
  for (std::size_t j = 1; j < rows.size(); ++j) {
    heights_m.push_back(heights_m.back() + MeanDistance(rows[j - 1], rows[j]));
  }
  const double span_m = heights_m.back() - heights_m.front();
  CheckExtension(options, &SurfaceOptions::foot_extension_mm, span_m, kSpanOfLines);
  CheckExtension(options, &SurfaceOptions::head_extension_mm, span_m, kSpanOfLines);
  parameters->length_v_m = heights_m.back() + parameters->above_m;
  for (double& height_m : heights_m) height_m /= parameters->length_v_m;
  return heights_m;
}

void AddRows(const std::vector<SurfaceRow>& rows, const std::vector<double>& vs,
             const SurfaceEdges& edges, SurfaceParameters* parameters) {
  std::vector<SurfaceObservation>& observations = parameters->observations;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const SurfaceRow& row = rows[j];
    const std::size_t first = observations.size();
    parameters->rows.push_back(
        {first, first + row.points.size() - 1, row.before_m, row.after_m, row.is_edge});
    for (std::size_t k = 0; k < row.points.size(); ++k) {
      const bool is_marker = row.marker_ids[k] >= 0;
      observations.push_back({row.marker_ids[k],
                              is_marker ? row.name : "",
                              row.us[k],
                              vs[j],
                              {{row.points[k], row.us[k], vs[j]}},
                              !is_marker && IsSeen(edges, rows, j, k)});
    }
    parameters->mean_length_u_m += row.length_m / rows.size();
  }
}

void ChooseKnots(const std::vector<SurfaceRow>& rows, const std::vector<double>& vs,
                 bool shows_between, SurfaceParameters* parameters) {
  std::vector<double> us;
  std::size_t max_points = 0;
  for (const SurfaceRow& row : rows) {
    us.insert(us.end(), row.us.begin(), row.us.end());
    max_points = std::max(max_points, row.points.size());
  }
  const int num_spans_u = std::clamp(static_cast<int>(max_points) - 1, 1, kMaxSpans);
  const int num_gaps = static_cast<int>(rows.size()) - 1;
  const int num_spans_v = std::min(shows_between ? 2 * num_gaps : num_gaps, kMaxSpans);
  parameters->degree_v = std::min(num_gaps, 3);
  parameters->knots_u = ClampedKnots(parameters->degree_u, QuantileKnots(us, num_spans_u));
  std::vector<double> interior_v;
  if (parameters->degree_v == 3) interior_v = QuantileKnots(vs, num_spans_v);
  parameters->knots_v = ClampedKnots(parameters->degree_v, interior_v);
}

}  // namespace

Eigen::Vector3d SurfaceObservation::Center() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const PlacedPoint& point : points) sum += point.x_in_shape_m;
  return sum / static_cast<double>(points.size());
}

SurfaceParameters AssignParameters(const std::vector<SurfaceLine>& lines, bool shows_between,
                                   const SurfaceOptions& options) {
  VELAMAP_CHECK(lines.size() >= 2);
  SurfaceParameters parameters;
  const double length_m = MeanLength(lines);
  CheckExtension(options, &SurfaceOptions::luff_extension_mm, length_m, kLengthOfLines);
  CheckExtension(options, &SurfaceOptions::leech_extension_mm, length_m, kLengthOfLines);
  const std::vector<SurfaceRow> rows = MakeSurfaceRows(lines, options, &parameters.notes);
  const std::vector<double> vs = PlaceRows(rows, options, &parameters);
  SetKnownSides(lines, options, &parameters);
  AddRows(rows, vs, options.edges, &parameters);
  ChooseKnots(rows, vs, shows_between, &parameters);
  return parameters;
}

void AddEdgePoints(const SurfaceEdges& edges, SurfaceParameters* parameters) {
  AddPointsOf(edges.luff, &ObservedRow::first_idx, &parameters->luff, parameters);
  AddPointsOf(edges.leech, &ObservedRow::last_idx, &parameters->leech, parameters);
}

}  // namespace velamap
