#include "exporters/surface/surface_input.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "exporters/shape/sail_lines.h"
#include "exporters/shape/shape_sigma.h"

namespace velamap {
namespace {

// A fourth of the variance of the corners' own errors.
std::optional<double> TiltSigma(const ShapeMarker& marker, double center_sigma_m) {
  constexpr double kMinOfCenter = 0.05;  // rounded sigmas, or the same for corners and centre
  double sum_m2 = 0.0;
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    if (!marker.sigma_m[corner]) return std::nullopt;
    sum_m2 += std::pow(SigmaOfCoordinate(*marker.sigma_m[corner]), 2);
  }
  const double own_m2 = OwnVarianceOfCorners(sum_m2 / kNumCorners, center_sigma_m * center_sigma_m);
  return std::max(std::sqrt(own_m2) / 2, kMinOfCenter * center_sigma_m);
}

std::optional<SurfaceMarker> Find(const MarkerShape& shape, int marker_id) {
  const ShapeMarker* found = FindWholeMarker(shape, marker_id);
  if (found == nullptr) return std::nullopt;
  const ShapeMarker& marker = *found;
  SurfaceMarker result{marker_id, *marker.x_in_shape_m[0], std::nullopt};
  for (std::size_t corner = 1; corner <= kNumCorners; ++corner) {
    result.corners_in_shape_m.push_back(*marker.x_in_shape_m[corner]);
  }
  if (!marker.sigma_m[0]) return result;
  result.sigma_m = SigmaOfCoordinate(*marker.sigma_m[0]);
  result.tilt_sigma_m = TiltSigma(marker, *result.sigma_m);
  return result;
}

std::optional<double> OffsetOf(const ClothEdge& edge, std::size_t line_idx) {
  if (edge.offsets_m.empty()) return std::nullopt;
  return edge.offsets_m[edge.offsets_m.size() == 1 ? 0 : line_idx];
}

// The whole markers of the vertical line on the edge; fewer than two are no edge, which is noted.
std::vector<Eigen::Vector3d> PointsOf(const char* name, const ClothEdge& edge,
                                      const LayoutPart& part, const MarkerShape& shape,
                                      std::string* note) {
  std::vector<Eigen::Vector3d> points;
  for (const MarkerLine& line : part.vertical) {
    if (edge.line.empty() || line.name != edge.line) continue;
    for (const int id : line.marker_ids) {
      const ShapeMarker* marker = FindWholeMarker(shape, id);
      if (marker != nullptr) points.push_back(*marker->x_in_shape_m[0]);
    }
  }
  if (points.size() >= 2) return points;
  if (!edge.line.empty()) {
    *note = fmt::format(
        "{}: {} of the markers of its line {} are whole, 2 needed; the surface ends at the outer "
        "markers of the other lines",
        name, points.size(), edge.line);
  }
  return {};
}

// Turns round the lines and the edges that the layout lists from head to foot. The offsets of foot
// and head belong to the cloth, and stay.
void OrderFromFootToHead(const MarkerShape& shape, const LayoutPart& part,
                         const std::optional<Eigen::Vector3d>& up_in_shape, SurfaceInput* input) {
  const std::optional<Eigen::Vector3d> up = up_in_shape ? up_in_shape : SailUp(shape, part);
  if (!up) return;
  const std::optional<Eigen::Vector3d> along = LinesUp(shape, part);
  if (along && PointsDown(*along, *up)) std::reverse(input->lines.begin(), input->lines.end());
  for (auto* edge : {&input->edges.luff, &input->edges.leech}) {
    if (edge->empty()) continue;
    if (PointsDown(edge->back() - edge->front(), *up)) std::reverse(edge->begin(), edge->end());
  }
}

}  // namespace

SurfaceInput CollectSurfaceInput(const MarkerShape& shape, const LayoutPart& part,
                                 const std::optional<Eigen::Vector3d>& up_in_shape) {
  SurfaceInput input;
  std::set<int> on_lines, others(part.marker_ids.begin(), part.marker_ids.end());
  for (const MarkerLine& line : part.horizontal) {
    const std::size_t idx = input.lines.size();
    SurfaceLine surface_line{
        line.name, {}, OffsetOf(part.edges.luff, idx), OffsetOf(part.edges.leech, idx)};
    for (const int marker_id : line.marker_ids) {
      surface_line.markers.push_back(Find(shape, marker_id));
      on_lines.insert(marker_id);
    }
    input.lines.push_back(surface_line);
  }
  input.foot_offset_m = OffsetOf(part.edges.foot, 0);
  input.head_offset_m = OffsetOf(part.edges.head, 0);
  input.edges.luff = PointsOf("luff", part.edges.luff, part, shape, &input.luff_note);
  input.edges.leech = PointsOf("leech", part.edges.leech, part, shape, &input.leech_note);
  for (const MarkerLine& line : part.vertical) {
    others.insert(line.marker_ids.begin(), line.marker_ids.end());
  }
  // Markers on an edge are points of the edge.
  for (const MarkerLine& line : part.vertical) {
    const bool is_edge = (line.name == part.edges.luff.line && !input.edges.luff.empty()) ||
                         (line.name == part.edges.leech.line && !input.edges.leech.empty());
    for (const int marker_id : line.marker_ids) {
      if (is_edge) others.erase(marker_id);
    }
  }
  for (const int marker_id : others) {
    if (on_lines.count(marker_id) > 0) continue;
    if (const auto marker = Find(shape, marker_id)) input.markers.push_back(*marker);
  }
  OrderFromFootToHead(shape, part, up_in_shape, &input);
  return input;
}

}  // namespace velamap
