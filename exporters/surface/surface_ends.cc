#include "exporters/surface/surface_ends.h"

#include <algorithm>

#include <fmt/format.h>

#include "exporters/shape/sail_lines.h"
#include "exporters/surface/surface_rows.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// Whether the surface can continue to an edge of the layout; notes why not.
bool IsWithinReach(double offset_m, double size_m, const char* edge, SortedInput* sorted) {
  if (offset_m <= kMaxReach * size_m) return true;
  sorted->notes.push_back(
      fmt::format("{}: the edge of the cloth is {:.3g} m from the outer markers, more than half of "
                  "the {:.3g} m that they cover; the surface ends at the markers",
                  edge, offset_m, size_m));
  return false;
}

double LengthOf(const SurfaceLine& line) {
  const std::vector<Eigen::Vector3d> points = PresentPoints(line);
  return (points.back() - points.front()).norm();
}

Eigen::Vector3d MiddleOf(const SurfaceLine& line) {
  const std::vector<Eigen::Vector3d> points = PresentPoints(line);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : points) sum += x;
  return sum / static_cast<double>(points.size());
}

constexpr const char* kEdgeNames[] = {"luff", "leech", "foot", "head"};

// What options, input and lines have of one edge.
struct EdgeMembers {
  const char* name;
  SurfaceEdge SurfaceEdges::*edge;
  std::optional<double> SurfaceOptions::*extension_mm;
  std::string SurfaceInput::*note;
};

// Takes the points of the layout, where the options do not say where the edge is. Returns whether
// the layout decides.
bool TakePoints(const EdgeMembers& members, const SurfaceInput& input,
                const SurfaceOptions& options, double size_m, SortedInput* sorted,
                SurfaceOptions* ends) {
  SurfaceEdge& edge = ends->edges.*members.edge;
  if (!edge.points_m.empty() || options.*members.extension_mm) return false;
  if (!(input.*members.note).empty()) sorted->notes.push_back(input.*members.note);
  edge = input.edges.*members.edge;
  if (!IsWithinReach(edge.beyond_m, size_m, members.name, sorted)) edge.beyond_m = 0.0;
  return true;
}

void EndSide(const EdgeMembers& edge, std::optional<double> SurfaceLine::*offset_m,
             const SurfaceInput& input, const SurfaceOptions& options, SortedInput* sorted,
             SurfaceOptions* ends) {
  bool is_within = TakePoints(edge, input, options, MeanLength(sorted->lines), sorted, ends);
  for (const SurfaceLine& line : sorted->lines) {
    const double reach_m = (line.*offset_m).value_or(0.0);
    is_within = is_within && IsWithinReach(reach_m, LengthOf(line), edge.name, sorted);
  }
  for (SurfaceLine& line : sorted->lines) {
    if (!is_within) (line.*offset_m).reset();
  }
}

// `has_line`: whether the surface has the line from which `offset_m` is measured.
void EndHeight(const EdgeMembers& edge, const std::optional<double>& offset_m, bool has_line,
               const SurfaceInput& input, const SurfaceOptions& options, SortedInput* sorted,
               SurfaceOptions* ends) {
  const double span_m = (MiddleOf(sorted->lines.back()) - MiddleOf(sorted->lines.front())).norm();
  if (!TakePoints(edge, input, options, span_m, sorted, ends) || !offset_m) return;
  if (!has_line) {
    sorted->notes.push_back(
        fmt::format("{}: the edge of the cloth is given from a line that is left out; the surface "
                    "ends at the next one",
                    edge.name));
  } else if (IsWithinReach(*offset_m, span_m, edge.name, sorted)) {
    ends->*edge.extension_mm = kMmPerM * *offset_m;
  }
}

}  // namespace

SurfaceOptions WithEdgesOf(const SurfaceInput& input, const SurfaceOptions& options,
                           SortedInput* sorted) {
  SurfaceOptions ends = options;
  EndSide(
      {"luff", &SurfaceEdges::luff, &SurfaceOptions::luff_extension_mm, &SurfaceInput::luff_note},
      &SurfaceLine::luff_offset_m, input, options, sorted, &ends);
  EndSide({"leech", &SurfaceEdges::leech, &SurfaceOptions::leech_extension_mm,
           &SurfaceInput::leech_note},
          &SurfaceLine::leech_offset_m, input, options, sorted, &ends);
  EndHeight(
      {"foot", &SurfaceEdges::foot, &SurfaceOptions::foot_extension_mm, &SurfaceInput::foot_note},
      input.foot_offset_m, input.lines.front().name == sorted->lines.front().name, input, options,
      sorted, &ends);
  EndHeight(
      {"head", &SurfaceEdges::head, &SurfaceOptions::head_extension_mm, &SurfaceInput::head_note},
      input.head_offset_m, input.lines.back().name == sorted->lines.back().name, input, options,
      sorted, &ends);
  return ends;
}

std::vector<SurfaceEdgePoint> EdgesOf(const SmoothSurface& smooth) {
  constexpr int kNumPoints = 41;
  std::vector<SurfaceEdgePoint> points;
  for (int edge = 0; edge < 4; ++edge) {
    for (int i = 0; i < kNumPoints; ++i) {
      const double along = static_cast<double>(i) / (kNumPoints - 1), end = edge % 2;
      const double u = edge < 2 ? end : along, v = edge < 2 ? along : end;
      points.push_back({kEdgeNames[edge], EvaluatePoint(smooth.surface, u, v),
                        SigmaAt(smooth.surface, smooth.pole_covariance_m2, u, v)});
    }
  }
  return points;
}

void NoteEdges(const SortedInput& sorted, const SurfaceOptions& ends,
               const std::vector<SurfaceEdgePoint>& edges, std::vector<std::string>* notes) {
  const auto goes_on = [&](const std::optional<double>& extension_mm,
                           std::optional<double> SurfaceLine::*offset_m) {
    if (extension_mm || offset_m == nullptr) return extension_mm.value_or(0.0) > 0;
    return std::any_of(sorted.lines.begin(), sorted.lines.end(),
                       [&](const SurfaceLine& line) { return (line.*offset_m).value_or(0.0) > 0; });
  };
  const SurfaceEdges& given = ends.edges;
  const std::map<std::string, bool> continued = {
      {"luff",
       given.luff.beyond_m > 0 || goes_on(ends.luff_extension_mm, &SurfaceLine::luff_offset_m)},
      {"leech",
       given.leech.beyond_m > 0 || goes_on(ends.leech_extension_mm, &SurfaceLine::leech_offset_m)},
      {"foot", given.foot.beyond_m > 0 || goes_on(ends.foot_extension_mm, nullptr)},
      {"head", given.head.beyond_m > 0 || goes_on(ends.head_extension_mm, nullptr)}};
  for (const char* name : kEdgeNames) {
    std::vector<double> sigmas_m;
    for (const SurfaceEdgePoint& point : edges) {
      if (point.edge == name && point.sigma_m) sigmas_m.push_back(*point.sigma_m);
    }
    if (!continued.at(name) || sigmas_m.empty()) continue;
    notes->push_back(
        fmt::format("{}: continued beyond the markers; its sigma there is {:.1f} mm (median), up "
                    "to {:.1f} mm",
                    name, kMmPerM * Median(sigmas_m),
                    kMmPerM * *std::max_element(sigmas_m.begin(), sigmas_m.end())));
  }
}

}  // namespace velamap
