// The lines of a layout, with those markers on them that no evidence has contradicted so far.
// Private to this folder.

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

using MarkersById = std::map<int, const PlacedMarker*>;  // not contradicted so far

struct Evidence {
  MarkersById markers;
  std::map<int, std::string> reasons;  // why a marker is contradicted, by marker id

  void Drop(int marker_id, std::string reason) {
    reasons.emplace(marker_id, std::move(reason));
    markers.erase(marker_id);
  }
};

// One line, with the markers on it that are still believed.
struct JudgedLine {
  const MarkerLine* line = nullptr;
  std::vector<const PlacedMarker*> markers;
  std::vector<LinePoint> points;
};

// The lines of the part that hold two markers or more.
std::vector<JudgedLine> LinesOf(const LayoutPart& part, const MarkersById& markers);

// The step that the long lines of a part have in common; nothing without a long line.
std::optional<double> StepOfPart(const std::vector<JudgedLine>& lines);

// A short line takes the step of its part unless its own step is certainly longer.
double StepOfLine(const JudgedLine& line, const std::optional<double>& step_of_part_m);

}  // namespace velamap
