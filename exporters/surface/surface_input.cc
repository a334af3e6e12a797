#include "exporters/surface/surface_input.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "exporters/shape/sail_lines.h"
#include "exporters/shape/shape_sigma.h"
#include "exporters/surface/surface_rows.h"

namespace velamap {
namespace {

// The variance of a tilt is a fourth of that of the corners' own errors.
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

// For luff and leech: the offset of a line, unless it counts from places along the edge.
std::optional<double> OffsetFromLine(const ClothEdge& edge, std::size_t line_idx) {
  return edge.HasPlaces() ? std::nullopt : edge.OffsetOfLine(line_idx);
}

// For foot and head, whose line is an outer one of the surface.
std::optional<double> OffsetFromOuterLine(const ClothEdge& edge) {
  if (!edge.line.empty()) return edge.OffsetOfLine(0).value_or(0.0);
  return OffsetFromLine(edge, 0);
}

// One of the four edges, where the layout names places along it.
struct EdgeOfPlaces {
  const char* name;
  bool is_side;  // luff or leech
  const ClothEdge& in_layout;
  SurfaceEdge& edge;
  std::string& note;
};

std::vector<EdgeOfPlaces> EdgesOfPlaces(const LayoutPart& part, SurfaceInput* input) {
  SurfaceEdges& edges = input->edges;
  return {{"luff", true, part.edges.luff, edges.luff, input->luff_note},
          {"leech", true, part.edges.leech, edges.leech, input->leech_note},
          {"foot", false, part.edges.foot, edges.foot, input->foot_note},
          {"head", false, part.edges.head, edges.head, input->head_note}};
}

// Sets the points of the edge that the shape has; fewer than two are no edge, which is noted.
// Markers at points where the cloth ends are removed from `others`.
void SetPoints(const MarkerShape& shape, const LayoutPart& part, const EdgeOfPlaces& places,
               std::set<int>* others) {
  const std::vector<CornerId> named =
      places.is_side ? PointsAlongSide(part, places.in_layout) : places.in_layout.points;
  if (named.empty()) return;
  const std::vector<Eigen::Vector3d> points_m = WholePoints(shape, named);
  if (points_m.size() < 2) {
    const std::string& line = places.in_layout.line;
    places.note =
        fmt::format("{}: {} of {} are whole, 2 needed; the surface ends at the outer markers{}",
                    places.name, points_m.size(),
                    line.empty() ? "the markers of its points" : "the markers of its line " + line,
                    places.is_side ? " of the other lines" : "");
    return;
  }
  SurfaceEdge& edge = places.edge;
  edge.points_m = points_m;
  edge.beyond_m = places.in_layout.OffsetOfLine(0).value_or(0.0);
  for (const CornerId& point : named) {
    const bool is_other = others->count(point.marker_id) > 0;
    if (point.corner == 0 && edge.beyond_m <= 0) others->erase(point.marker_id);
    edge.is_seen = edge.is_seen || !is_other || others->count(point.marker_id) > 0;
  }
}

bool RunsAgainst(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Vector3d& direction) {
  return !points_m.empty() && (points_m.back() - points_m.front()).dot(direction) < 0;
}

// Turns round foot and head where they are named from leech to luff.
void OrderFromLuffToLeech(SurfaceInput* input) {
  Eigen::Vector3d aft = Eigen::Vector3d::Zero();
  for (const SurfaceLine& line : input->lines) {
    const std::vector<Eigen::Vector3d> points_m = PresentPoints(line);
    if (points_m.size() >= 2) aft += (points_m.back() - points_m.front()).normalized();
  }
  for (auto* points_m : {&input->edges.foot.points_m, &input->edges.head.points_m}) {
    if (RunsAgainst(*points_m, aft)) std::reverse(points_m->begin(), points_m->end());
  }
}

// Drops and notes the offset of a foot or head whose line is not the outer one of this shape.
void CheckOuterLines(const LayoutPart& part, SurfaceInput* input) {
  const auto check = [](const char* name, const ClothEdge& edge, const SurfaceLine& outer,
                        std::optional<double>* offset_m, std::string* note) {
    if (edge.line.empty() || edge.line == outer.name) return;
    offset_m->reset();
    *note = fmt::format("{}: its line {} is at the other end of the sail; the surface ends at {}",
                        name, edge.line, outer.name);
  };
  check("foot", part.edges.foot, input->lines.front(), &input->foot_offset_m, &input->foot_note);
  check("head", part.edges.head, input->lines.back(), &input->head_offset_m, &input->head_note);
}

// Turns round the lines and the edges that the layout lists from head to foot. The offsets of foot
// and head belong to the cloth, and stay.
void OrderFromFootToHead(const MarkerShape& shape, const LayoutPart& part,
                         const std::optional<Eigen::Vector3d>& up_in_shape, SurfaceInput* input) {
  const std::optional<Eigen::Vector3d> up = up_in_shape ? up_in_shape : SailUp(shape, part);
  if (!up) return;
  const std::optional<Eigen::Vector3d> along = LinesUp(shape, part);
  if (along && PointsDown(*along, *up)) std::reverse(input->lines.begin(), input->lines.end());
  for (auto* points_m : {&input->edges.luff.points_m, &input->edges.leech.points_m}) {
    if (points_m->empty() || !PointsDown(points_m->back() - points_m->front(), *up)) continue;
    std::reverse(points_m->begin(), points_m->end());
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
        line.name, {}, OffsetFromLine(part.edges.luff, idx), OffsetFromLine(part.edges.leech, idx)};
    for (const int marker_id : line.marker_ids) {
      surface_line.markers.push_back(Find(shape, marker_id));
      on_lines.insert(marker_id);
    }
    input.lines.push_back(surface_line);
  }
  input.foot_offset_m = OffsetFromOuterLine(part.edges.foot);
  input.head_offset_m = OffsetFromOuterLine(part.edges.head);
  for (const MarkerLine& line : part.vertical) {
    others.insert(line.marker_ids.begin(), line.marker_ids.end());
  }
  for (const EdgeOfPlaces& places : EdgesOfPlaces(part, &input)) {
    SetPoints(shape, part, places, &others);
  }
  for (const int marker_id : others) {
    if (on_lines.count(marker_id) > 0) continue;
    if (const auto marker = Find(shape, marker_id)) input.markers.push_back(*marker);
  }
  OrderFromFootToHead(shape, part, up_in_shape, &input);
  OrderFromLuffToLeech(&input);
  if (!input.lines.empty()) CheckOuterLines(part, &input);
  return input;
}

}  // namespace velamap
