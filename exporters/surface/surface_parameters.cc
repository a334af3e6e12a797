#include "exporters/surface/surface_parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

using Polyline = std::vector<Eigen::Vector3d>;

constexpr int kMaxSpans = 20;     // in each direction; no sail has more markers on a line
constexpr int kLineSamples = 9;   // at which neighbouring lines are compared
constexpr double kWideGap = 2.5;  // in mean spacings; wider gaps get a note

// A line, or a foot or head edge, with u of its points.
struct Row {
  std::string name;
  std::vector<int> marker_ids;
  Polyline points;
  std::vector<double> us;
  double length_m = 0.0;
};

// The point of the edge nearest to the straight continuation of a line, a ray from `start`.
Eigen::Vector3d NearestToRay(const Polyline& edge, const Eigen::Vector3d& start,
                             const Eigen::Vector3d& direction) {
  Eigen::Vector3d best = edge.front();
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < edge.size(); ++k) {
    const Eigen::Vector3d along = edge[k + 1] - edge[k];
    // The squared distance from the line of the ray is quadratic in the position on the segment.
    const Eigen::Vector3d across = along - direction * direction.dot(along);
    const Eigen::Vector3d offset = edge[k] - start - direction * direction.dot(edge[k] - start);
    const double size = across.squaredNorm();
    const double place = size > 0 ? std::clamp(-across.dot(offset) / size, 0.0, 1.0) : 0.0;
    const Eigen::Vector3d candidate = edge[k] + place * along;
    const Eigen::Vector3d from_start = candidate - start;
    const double ahead = std::max(0.0, direction.dot(from_start));
    const double distance = (from_start - ahead * direction).norm();
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

struct PresentMarkers {
  std::vector<std::size_t> places;  // in the line of the layout
  std::vector<int> marker_ids;
  Polyline points;
};

PresentMarkers Present(const SurfaceLine& line) {
  PresentMarkers present;
  for (std::size_t place = 0; place < line.markers.size(); ++place) {
    if (!line.markers[place]) continue;
    present.places.push_back(place);
    present.marker_ids.push_back(line.markers[place]->marker_id);
    present.points.push_back(line.markers[place]->x_in_shape_m);
  }
  return present;
}

void NoteGaps(const SurfaceLine& line, const PresentMarkers& present,
              const std::vector<double>& lengths, std::vector<std::string>* notes) {
  const double spacing = lengths.back() / (lengths.size() - 1);
  for (std::size_t k = 1; k < lengths.size(); ++k) {
    const std::size_t num_missing = present.places[k] - present.places[k - 1] - 1;
    const double gap_m = lengths[k] - lengths[k - 1];
    if (num_missing == 0 && gap_m < kWideGap * spacing) continue;
    notes->push_back(fmt::format(
        "line {}: gap of {:.3g} m between markers {} and {} ({} of the layout missing), filled",
        line.name, gap_m, present.marker_ids[k - 1], present.marker_ids[k], num_missing));
  }
  const std::size_t missing_luff = present.places.front();
  const std::size_t missing_leech = line.markers.size() - 1 - present.places.back();
  if (missing_luff + missing_leech > 0) {
    notes->push_back(fmt::format(
        "line {}: {} markers missing at the luff and {} at the leech; the surface follows the "
        "neighboring lines there",
        line.name, missing_luff, missing_leech));
  }
}

void CheckApart(const SurfaceLine& line, const PresentMarkers& present) {
  for (std::size_t k = 1; k < present.points.size(); ++k) {
    if ((present.points[k] - present.points[k - 1]).norm() > 1e-6) continue;
    throw DataError(
        fmt::format("line {}: markers {} and {} are in the same place; check the layout", line.name,
                    present.marker_ids[k - 1], present.marker_ids[k]));
  }
}

// One end of a line: how far the surface continues beyond the last marker, and the edge point.
struct LineEnd {
  double length_m = 0.0;
  std::optional<Eigen::Vector3d> edge_point;
};

double BeyondMarkers(const std::optional<double>& extension_mm,
                     const std::optional<double>& offset_m) {
  return extension_mm ? kMPerMm * *extension_mm : offset_m.value_or(0.0);
}

LineEnd MakeLineEnd(const Polyline& edge, double extension_m, double missing_m,
                    const Eigen::Vector3d& last, const Eigen::Vector3d& before_last) {
  if (edge.empty()) return {missing_m + extension_m, std::nullopt};
  const Eigen::Vector3d x = NearestToRay(edge, last, (last - before_last).normalized());
  const double length_m = (x - last).norm();
  if (length_m < 1e-6) return {};  // the marker lies on the edge
  return {length_m, x};
}

Row MakeRow(const SurfaceLine& line, const SurfaceOptions& options,
            std::vector<std::string>* notes) {
  const PresentMarkers present = Present(line);
  CheckApart(line, present);
  const std::vector<double> lengths = ChordLengths(present.points);
  NoteGaps(line, present, lengths, notes);
  const double place_spacing = lengths.back() / (present.places.back() - present.places.front());
  const std::size_t n = present.points.size();
  const LineEnd luff =
      MakeLineEnd(options.edges.luff, BeyondMarkers(options.luff_extension_mm, line.luff_offset_m),
                  place_spacing * present.places.front(), present.points[0], present.points[1]);
  const LineEnd leech = MakeLineEnd(
      options.edges.leech, BeyondMarkers(options.leech_extension_mm, line.leech_offset_m),
      place_spacing * (line.markers.size() - 1 - present.places.back()), present.points[n - 1],
      present.points[n - 2]);
  Row row{line.name, present.marker_ids, present.points, {}, 0.0};
  row.length_m = luff.length_m + lengths.back() + leech.length_m;
  for (const double length : lengths) row.us.push_back((luff.length_m + length) / row.length_m);
  if (luff.edge_point) {
    row.marker_ids.insert(row.marker_ids.begin(), -1);
    row.points.insert(row.points.begin(), *luff.edge_point);
    row.us.insert(row.us.begin(), 0.0);
  }
  if (leech.edge_point) {
    row.marker_ids.push_back(-1);
    row.points.push_back(*leech.edge_point);
    row.us.push_back(1.0);
  }
  return row;
}

Row MakeEdgeRow(const std::string& name, const Polyline& edge) {
  Row row{name, std::vector<int>(edge.size(), -1), edge, ChordLengths(edge), 0.0};
  row.length_m = row.us.back();
  if (row.length_m < 1e-6) {
    throw InputError(fmt::format("the {} edge has no length; remove it", name));
  }
  for (double& u : row.us) u /= row.length_m;
  return row;
}

Eigen::Vector3d PointAtU(const Row& row, double u) {
  const auto above = std::upper_bound(row.us.begin() + 1, row.us.end() - 1, u);
  const std::size_t k = above - row.us.begin();
  const double part = (u - row.us[k - 1]) / (row.us[k] - row.us[k - 1]);
  return row.points[k - 1] + part * (row.points[k] - row.points[k - 1]);
}

// Mean distance between two neighbouring lines over their common range of u.
double MeanDistance(const Row& lower, const Row& upper) {
  const double first = std::max(lower.us.front(), upper.us.front());
  const double last = std::min(lower.us.back(), upper.us.back());
  std::vector<Eigen::Vector3d> gaps;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (int i = 0; i < kLineSamples; ++i) {
    const double u = first + (last - first) * i / (kLineSamples - 1);
    gaps.push_back(PointAtU(upper, u) - PointAtU(lower, u));
    mean += gaps.back() / kLineSamples;
    sum += gaps.back().norm();
  }
  const Eigen::Vector3d along_lower = lower.points.back() - lower.points.front();
  const Eigen::Vector3d along_upper = upper.points.back() - upper.points.front();
  if (along_lower.dot(along_upper) < 0) {
    throw DataError(fmt::format(
        "lines {} and {} run in opposite directions; list both from luff to leech in the layout",
        lower.name, upper.name));
  }
  for (const Eigen::Vector3d& gap : gaps) {
    if (gap.dot(mean) > 0) continue;
    throw DataError(fmt::format(
        "lines {} and {} cross; check their order (foot to head) and their ids in the layout",
        lower.name, upper.name));
  }
  return sum / kLineSamples;
}

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

double MeanLength(const std::vector<SurfaceLine>& lines) {
  double sum_m = 0.0;
  for (const SurfaceLine& line : lines) sum_m += ChordLengths(Present(line).points).back();
  return sum_m / static_cast<double>(lines.size());
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

std::vector<Row> MakeRows(const std::vector<SurfaceLine>& lines, const SurfaceOptions& options,
                          std::vector<std::string>* notes) {
  std::vector<Row> rows;
  if (!options.edges.foot.empty()) rows.push_back(MakeEdgeRow("foot", options.edges.foot));
  for (const SurfaceLine& line : lines) rows.push_back(MakeRow(line, options, notes));
  if (!options.edges.head.empty()) rows.push_back(MakeEdgeRow("head", options.edges.head));
  return rows;
}

}  // namespace

std::vector<double> ChordLengths(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> lengths = {0.0};
  for (std::size_t k = 1; k < points.size(); ++k) {
    lengths.push_back(lengths.back() + (points[k] - points[k - 1]).norm());
  }
  return lengths;
}

SurfaceParameters AssignParameters(const std::vector<SurfaceLine>& lines, bool has_markers_between,
                                   const SurfaceOptions& options) {
  VELAMAP_CHECK(lines.size() >= 2);
  SurfaceParameters parameters;
  const double length_m = MeanLength(lines);
  for (const auto extension_mm :
       {&SurfaceOptions::luff_extension_mm, &SurfaceOptions::leech_extension_mm}) {
    CheckExtension(options, extension_mm, length_m, "the length of the lines");
  }
  const std::vector<Row> rows = MakeRows(lines, options, &parameters.notes);
  std::vector<double> heights_m = {kMPerMm * options.foot_extension_mm.value_or(0.0)};
  for (std::size_t j = 1; j < rows.size(); ++j) {
    heights_m.push_back(heights_m.back() + MeanDistance(rows[j - 1], rows[j]));
  }
  const double span_m = heights_m.back() - heights_m.front();
  for (const auto extension_mm :
       {&SurfaceOptions::foot_extension_mm, &SurfaceOptions::head_extension_mm}) {
    CheckExtension(options, extension_mm, span_m,
                   "the distance from the lowest to the highest line");
  }
  parameters.length_v_m = heights_m.back() + kMPerMm * options.head_extension_mm.value_or(0.0);

  std::vector<double> all_us, line_vs;
  std::size_t max_points = 0;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const double v = heights_m[j] / parameters.length_v_m;
    for (std::size_t k = 0; k < rows[j].points.size(); ++k) {
      parameters.observations.push_back({rows[j].marker_ids[k],
                                         rows[j].marker_ids[k] < 0 ? "" : rows[j].name,
                                         rows[j].points[k], rows[j].us[k], v});
      all_us.push_back(rows[j].us[k]);
    }
    line_vs.push_back(v);
    parameters.mean_length_u_m += rows[j].length_m / rows.size();
    max_points = std::max(max_points, rows[j].points.size());
  }
  const int num_spans_u = std::clamp(static_cast<int>(max_points) - 1, 1, kMaxSpans);
  const int num_gaps = static_cast<int>(rows.size()) - 1;
  const int num_spans_v = std::min(has_markers_between ? 2 * num_gaps : num_gaps, kMaxSpans);
  parameters.degree_v = std::min(num_gaps, 3);
  parameters.knots_u = ClampedKnots(parameters.degree_u, QuantileKnots(all_us, num_spans_u));
  std::vector<double> interior_v;
  if (parameters.degree_v == 3) interior_v = QuantileKnots(line_vs, num_spans_v);
  parameters.knots_v = ClampedKnots(parameters.degree_v, interior_v);
  return parameters;
}

}  // namespace velamap
