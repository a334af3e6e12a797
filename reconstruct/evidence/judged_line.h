// The lines of a layout, restricted to the markers that no evidence contradicts so far.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/evidence/layout_evidence.h"
#include "reconstruct/evidence/line_evidence.h"

namespace velamap {

using MarkersById = std::map<int, const PlacedMarker*>;

struct Evidence {
  MarkersById markers;                 // those that are not contradicted so far
  std::map<int, std::string> reasons;  // why the other markers are contradicted, by marker id

  void Drop(int marker_id, std::string reason) {
    reasons.emplace(marker_id, std::move(reason));
    markers.erase(marker_id);
  }
};

// `markers` and `points` are parallel and in the order of the line.
struct JudgedLine {
  const MarkerLine* line = nullptr;
  std::vector<const PlacedMarker*> markers;
  std::vector<LinePoint> points;
};

// The horizontal and vertical lines of the part on which at least two of `markers` lie.
std::vector<JudgedLine> LinesOf(const LayoutPart& part, const MarkersById& markers);

// The median step, m, of the lines with at least kMinPointsForStep points, or nothing if there are
// none.
std::optional<double> StepOfPart(const std::vector<JudgedLine>& lines);

// The step of a line, m. A line that is too short for an estimate of its own takes the step of its
// part, unless its markers are all farther apart.
double StepOfLine(const JudgedLine& line, const std::optional<double>& step_of_part_m);

}  // namespace velamap
