#include "exporters/surface/surface_rows.h"

#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <unsupported/Eigen/Splines>

#include "exporters/shape/sail_lines.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

using Polyline = std::vector<Eigen::Vector3d>;

constexpr int kLineSamples = 9;   // at which neighbouring lines are compared
constexpr double kWideGap = 2.5;  // in mean spacings; wider gaps get a note

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
  const std::string missing =
      MissingEndsText(static_cast<int>(present.places.front()),
                      static_cast<int>(line.markers.size() - 1 - present.places.back()));
  if (!missing.empty()) {
    notes->push_back(fmt::format("line {}: {}; the surface follows the neighbouring lines there",
                                 line.name, missing));
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

// One end of a line: how far the surface continues beyond the last marker, how far beyond the last
// point, and the point on a given edge.
struct LineEnd {
  double length_m = 0.0;
  double after_point_m = 0.0;
  std::optional<Eigen::Vector3d> edge_point;
};

double BeyondMarkers(const std::optional<double>& extension_mm,
                     const std::optional<double>& offset_m) {
  return extension_mm ? kMPerMm * *extension_mm : offset_m.value_or(0.0);
}

// `edge` has the curve that SmoothEdge() makes.
LineEnd MakeLineEnd(const SurfaceEdge& edge, double extension_m, double missing_m,
                    const Eigen::Vector3d& last, const Eigen::Vector3d& before_last) {
  if (edge.points_m.empty())
    return {missing_m + extension_m, missing_m + extension_m, std::nullopt};
  const Eigen::Vector3d direction = (last - before_last).normalized();
  const Eigen::Vector3d x = NearestToRay(edge.points_m, last, direction);
  const double length_m = (x - last).norm();
  // The marker lies on the edge, or beyond a curve through a few points of a round one.
  if (direction.dot(x - last) < 1e-6) return {edge.beyond_m, edge.beyond_m, std::nullopt};
  return {length_m + edge.beyond_m, edge.beyond_m, x};
}

SurfaceRow MakeRow(const SurfaceLine& line, const SurfaceOptions& options,
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
  SurfaceRow row{line.name, false, present.marker_ids, present.points, {}};
  row.before_m = luff.after_point_m;
  row.after_m = leech.after_point_m;
  row.length_m = luff.length_m + lengths.back() + leech.length_m;
  for (const double length : lengths) row.us.push_back((luff.length_m + length) / row.length_m);
  if (luff.edge_point) {
    row.marker_ids.insert(row.marker_ids.begin(), -1);
    row.points.insert(row.points.begin(), *luff.edge_point);
    row.us.insert(row.us.begin(), row.before_m / row.length_m);
  }
  if (leech.edge_point) {
    row.marker_ids.push_back(-1);
    row.points.push_back(*leech.edge_point);
    row.us.push_back(1.0 - row.after_m / row.length_m);
  }
  return row;
}

// The u of its points follow from where its ends are beside the nearest line.
SurfaceRow MakeEdgeRow(const std::string& name, const Polyline& edge, const SurfaceRow& line) {
  SurfaceRow row{name, true, std::vector<int>(edge.size(), -1), edge, ChordLengths(edge)};
  row.length_m = row.us.back();
  if (row.length_m < 1e-6) {
    throw InputError(fmt::format("the {} edge has no length; remove it", name));
  }
  const Eigen::Vector3d chord_m = line.points.back() - line.points.front();
  const auto beside = [&](const Eigen::Vector3d& x) {
    const double part = chord_m.dot(x - line.points.front()) / chord_m.squaredNorm();
    return std::clamp(line.us.front() + part * (line.us.back() - line.us.front()), 0.0, 1.0);
  };
  const double first = beside(edge.front()), last = beside(edge.back());
  const bool is_beside = last - first > 0.1;
  for (double& u : row.us) {
    u /= row.length_m;
    if (is_beside) u = first + u * (last - first);
  }
  return row;
}

Eigen::Vector3d PointAtU(const SurfaceRow& row, double u) {
  const auto above = std::upper_bound(row.us.begin() + 1, row.us.end() - 1, u);
  const std::size_t k = above - row.us.begin();
  const double part = (u - row.us[k - 1]) / (row.us[k] - row.us[k - 1]);
  return row.points[k - 1] + part * (row.points[k] - row.points[k - 1]);
}

// The smooth curve through the points as a polyline with short steps. It continues straight beyond
// them by their mean distance.
Polyline SmoothEdge(const Polyline& points) {
  constexpr int kEdgeLineDegree = 3, kStepsPerPoint = 8;
  if (points.size() < 2) return points;
  const auto n = static_cast<Eigen::Index>(points.size());
  const std::vector<double> lengths_m = ChordLengths(points);
  const Eigen::Map<const Eigen::Matrix3Xd> places_m(points.front().data(), 3, n);
  const Eigen::RowVectorXd places =
      Eigen::Map<const Eigen::RowVectorXd>(lengths_m.data(), n) / lengths_m.back();
  using Spline = Eigen::Spline<double, 3>;
  const Spline curve = Eigen::SplineFitting<Spline>::Interpolate(
      places_m, std::min<Eigen::Index>(kEdgeLineDegree, n - 1), places);
  Polyline smooth;
  const int num_steps = kStepsPerPoint * static_cast<int>(n - 1);
  for (int k = 0; k <= num_steps; ++k) {
    smooth.emplace_back(curve(static_cast<double>(k) / num_steps));
  }
  // A line beside the ends of an edge meets it as the edge goes on there.
  const double spacing_m = lengths_m.back() / static_cast<double>(n - 1);
  const auto go_on = [&](const Eigen::Vector3d& end, const Eigen::Vector3d& before_end) {
    return Eigen::Vector3d(end + spacing_m * (end - before_end).normalized());
  };
  smooth.insert(smooth.begin(), go_on(smooth[0], smooth[1]));
  smooth.push_back(go_on(smooth.back(), smooth[smooth.size() - 2]));
  return smooth;
}

}  // namespace

std::vector<Eigen::Vector3d> PresentPoints(const SurfaceLine& line) { return Present(line).points; }

std::vector<double> ChordLengths(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> lengths = {0.0};
  for (std::size_t k = 1; k < points.size(); ++k) {
    lengths.push_back(lengths.back() + (points[k] - points[k - 1]).norm());
  }
  return lengths;
}

std::vector<Eigen::Vector3d> SomePoints(const std::vector<Eigen::Vector3d>& points) {
  constexpr std::size_t kMaxPoints = 40;
  constexpr double kApart_m = 1e-6;
  const std::size_t n = std::min(points.size(), kMaxPoints);
  Polyline some;
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::Vector3d& x = points[n < 2 ? k : k * (points.size() - 1) / (n - 1)];
    if (some.empty() || (x - some.back()).norm() > kApart_m) some.push_back(x);
  }
  return some;
}

double MeanLength(const std::vector<SurfaceLine>& lines) {
  double sum_m = 0.0;
  for (const SurfaceLine& line : lines) sum_m += ChordLengths(PresentPoints(line)).back();
  return sum_m / static_cast<double>(lines.size());
}

std::vector<SurfaceRow> MakeSurfaceRows(const std::vector<SurfaceLine>& lines,
                                        const SurfaceOptions& options,
                                        std::vector<std::string>* notes) {
  SurfaceOptions smooth = options;
  for (auto* edge : {&smooth.edges.luff, &smooth.edges.leech}) {
    edge->points_m = SmoothEdge(SomePoints(edge->points_m));
  }
  std::vector<SurfaceRow> rows;
  for (const SurfaceLine& line : lines) rows.push_back(MakeRow(line, smooth, notes));
  const Polyline &foot = options.edges.foot.points_m, &head = options.edges.head.points_m;
  if (!foot.empty()) {
    rows.insert(rows.begin(), MakeEdgeRow("foot", SomePoints(foot), rows.front()));
  }
  if (!head.empty()) {
    rows.push_back(MakeEdgeRow("head", SomePoints(head), rows.back()));
  }
  return rows;
}

double MeanDistance(const SurfaceRow& lower, const SurfaceRow& upper) {
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

}  // namespace velamap
