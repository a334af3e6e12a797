#include "reconstruct/evidence/judged_line.h"

#include <algorithm>

#include "importer/base/statistics.h"

namespace velamap {

std::vector<JudgedLine> LinesOf(const LayoutPart& part, const MarkersById& markers) {
  std::vector<JudgedLine> lines;
  for (const std::vector<MarkerLine>* direction : {&part.horizontal, &part.vertical}) {
    for (const MarkerLine& line : *direction) {
      JudgedLine judged{&line, {}, {}};
      for (std::size_t place = 0; place < line.marker_ids.size(); ++place) {
        const auto marker = markers.find(line.marker_ids[place]);
        if (marker == markers.end()) continue;
        judged.markers.push_back(marker->second);
        judged.points.push_back({static_cast<int>(place), marker->second->center_in_shape_m,
                                 marker->second->sigma_m, Trust::kWellSeen});
      }
      if (judged.points.size() >= 2) lines.push_back(std::move(judged));
    }
  }
  return lines;
}

std::optional<double> StepOfPart(const std::vector<JudgedLine>& lines) {
  std::vector<double> steps_m;
  for (const JudgedLine& line : lines) {
    if (line.points.size() >= kMinPointsForStep) steps_m.push_back(EstimateStep(line.points));
  }
  if (steps_m.empty()) return std::nullopt;
  return Median(std::move(steps_m));
}

double StepOfLine(const JudgedLine& line, const std::optional<double>& step_of_part_m) {
  if (line.points.size() >= kMinPointsForStep || !step_of_part_m) return EstimateStep(line.points);
  return std::max(*step_of_part_m, SmallestStep(line.points));
}

}  // namespace velamap
