#include "reconstruct/evidence/layout_evidence.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/base/statistics.h"
#include "reconstruct/evidence/judged_line.h"
#include "reconstruct/evidence/line_evidence.h"
#include "reconstruct/evidence/rival_evidence.h"

namespace velamap {
namespace {

std::string SeenText(const PlacedMarker& marker) {
  return marker.num_should_see > marker.num_seen_of_these
             ? fmt::format(", seen in {} of {} images that should show it",
                           marker.num_seen_of_these, marker.num_should_see)
             : fmt::format(", seen in {} images", marker.num_seen);
}

double SeenRatio(const PlacedMarker& marker) {
  return marker.num_should_see > 0
             ? static_cast<double>(marker.num_seen_of_these) / marker.num_should_see
             : 1.0;
}

// How often the neighbours of a marker are seen: the medians over the next two markers on each side
// on all of its lines, or over all markers if it is on no line.
struct UsuallySeen {
  double ratio = 0.0;       // images that show a marker / images that should
  double num_images = 0.0;  // images that show a marker
};

UsuallySeen NeighborsSeen(const std::vector<JudgedLine>& lines, const MarkersById& markers,
                          int marker_id) {
  constexpr std::size_t kNumOnEachSide = 2;
  std::vector<double> ratios, nums_seen;
  const auto add = [&](const PlacedMarker& marker) {
    ratios.push_back(SeenRatio(marker));
    nums_seen.push_back(marker.num_seen);
  };
  for (const JudgedLine& line : lines) {
    for (std::size_t i = 0; i < line.markers.size(); ++i) {
      if (line.markers[i]->marker_id != marker_id) continue;
      const std::size_t begin = i < kNumOnEachSide ? 0 : i - kNumOnEachSide;
      for (std::size_t j = begin; j < std::min(line.markers.size(), i + kNumOnEachSide + 1); ++j) {
        if (j != i) add(*line.markers[j]);
      }
    }
  }
  if (ratios.empty()) {
    for (const auto& [id, marker] : markers) add(*marker);
  }
  return {Median(std::move(ratios)), Median(std::move(nums_seen))};
}

// The ratio is not used if fewer than ten images should show the marker. A marker that few images
// show can still be a true one, unless more than five times as many show its neighbours.
Trust TrustOf(const PlacedMarker& marker, const UsuallySeen& neighbors) {
  constexpr double kSeldom = 0.2, kOftenMissed = 0.5, kMinImages = 10;
  const bool is_known = marker.num_should_see >= kMinImages;
  const double part_of_usual = is_known ? SeenRatio(marker) / neighbors.ratio : 1.0;
  if (part_of_usual < kSeldom ||
      (neighbors.num_images >= kMinImages && marker.num_seen < kSeldom * neighbors.num_images)) {
    return Trust::kSeldomSeen;
  }
  return part_of_usual < kOftenMissed ? Trust::kOftenMissed : Trust::kWellSeen;
}

// The reason for contradicting a stray marker. It names the nearest markers that are not stray.
std::string WhyStray(const JudgedLine& line, const std::vector<std::size_t>& stray_idxs,
                     std::size_t idx, double step_m) {
  const auto is_stray = [&](std::size_t i) {
    return std::binary_search(stray_idxs.begin(), stray_idxs.end(), i);
  };
  std::size_t before = idx, after = idx + 1;
  while (before > 0 && is_stray(before - 1)) --before;
  while (after < line.points.size() && is_stray(after)) ++after;
  std::string neighbors;
  const auto add = [&](std::size_t other) {
    neighbors +=
        fmt::format("{}{:.2f} m from marker {}", neighbors.empty() ? "" : " and ",
                    (line.points[other].x_in_shape_m - line.points[idx].x_in_shape_m).norm(),
                    line.markers[other]->marker_id);
  };
  if (before > 0) add(before - 1);
  if (after < line.points.size()) add(after);
  return fmt::format(
             "contradicts the layout: on line {} it is {}, where neighbours are up to {:.2f} "
             "m apart",
             line.line->name, neighbors, step_m) +
         SeenText(*line.markers[idx]);
}

// What the lines say about a marker. It is contradicted only if all of its lines contradict it.
struct Judgement {
  int num_lines = 0, num_against = 0;
  std::string reason;  // from the first line that contradicts it
};

// Judges the markers that are alone on a line with one other marker, if another line confirms that
// one. Adds to `judgements`, which hold what the longer lines say.
void JudgePairs(const std::vector<JudgedLine>& lines, double step_m,
                std::map<int, Judgement>* judgements) {
  const std::map<int, Judgement> by_longer_lines = *judgements;
  const auto is_confirmed = [&](const PlacedMarker* marker) {
    const auto found = by_longer_lines.find(marker->marker_id);
    return found != by_longer_lines.end() && found->second.num_against < found->second.num_lines;
  };
  for (const JudgedLine& line : lines) {
    if (line.points.size() != 2) continue;
    const bool is_first_confirmed = is_confirmed(line.markers[0]);
    if (is_first_confirmed == is_confirmed(line.markers[1])) continue;
    const std::size_t doubted = is_first_confirmed ? 1 : 0;
    Judgement& judgement = (*judgements)[line.markers[doubted]->marker_id];
    ++judgement.num_lines;
    if (IsStrayFrom(line.points[1 - doubted], line.points[doubted], step_m) &&
        judgement.num_against++ == 0) {
      judgement.reason = WhyStray(line, {doubted}, doubted, step_m);
    }
  }
}

// Holds the markers on lines with at least kMinPointsOnLine markers, and those of JudgePairs(), by
// id.
std::map<int, Judgement> JudgeByLines(const LayoutPart& part, const MarkersById& markers) {
  std::vector<JudgedLine> lines = LinesOf(part, markers);
  std::map<int, Judgement> judgements;
  const std::optional<double> step_of_part_m = StepOfPart(lines);
  for (JudgedLine& line : lines) {
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      line.points[i].trust =
          TrustOf(*line.markers[i], NeighborsSeen(lines, markers, line.markers[i]->marker_id));
    }
    if (line.points.size() < kMinPointsOnLine) continue;
    for (const PlacedMarker* marker : line.markers) ++judgements[marker->marker_id].num_lines;
    const double step_m = StepOfLine(line, step_of_part_m);
    const std::vector<std::size_t> stray_idxs = FindStrayPoints(line.points, step_m);
    for (const std::size_t idx : stray_idxs) {
      Judgement& judgement = judgements[line.markers[idx]->marker_id];
      if (judgement.num_against++ == 0) {
        judgement.reason = WhyStray(line, stray_idxs, idx, step_m);
      }
    }
  }
  if (step_of_part_m) JudgePairs(lines, *step_of_part_m, &judgements);
  return judgements;
}

bool DropStrayMarkers(const LayoutPart& part, Evidence* evidence) {
  bool changed = false;
  for (auto& [marker_id, judgement] : JudgeByLines(part, evidence->markers)) {
    if (judgement.num_against == 0 || judgement.num_against < judgement.num_lines) continue;
    evidence->Drop(marker_id, std::move(judgement.reason));
    changed = true;
  }
  return changed;
}

// Drops seldom seen markers that no line can judge and that are far from the others of their part.
// An empty `ids_of_part` stands for all markers.
void DropFarMarkers(const std::set<int>& ids_of_part, const std::map<int, Judgement>& judged,
                    Evidence* evidence) {
  constexpr std::size_t kMinForExtent = 4;
  constexpr double kGross = 2.0, kNumSigmas = 2.0;
  std::vector<const PlacedMarker*> well_seen, seldom_seen;
  const UsuallySeen usual = NeighborsSeen({}, evidence->markers, -1);
  for (const auto& [id, marker] : evidence->markers) {
    if (!ids_of_part.empty() && ids_of_part.count(id) == 0) continue;
    const Trust trust = TrustOf(*marker, usual);
    if (trust != Trust::kSeldomSeen) well_seen.push_back(marker);
    if (trust == Trust::kSeldomSeen && judged.count(id) == 0) seldom_seen.push_back(marker);
  }
  if (well_seen.size() < kMinForExtent) return;
  double extent_m = 0.0;
  for (const PlacedMarker* a : well_seen) {
    for (const PlacedMarker* b : well_seen) {
      extent_m = std::max(extent_m, (a->center_in_shape_m - b->center_in_shape_m).norm());
    }
  }
  for (const PlacedMarker* marker : seldom_seen) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const PlacedMarker* other : well_seen) {
      nearest_m =
          std::min(nearest_m, (other->center_in_shape_m - marker->center_in_shape_m).norm());
    }
    if (nearest_m <= kGross * extent_m + kNumSigmas * marker->sigma_m) continue;
    evidence->Drop(marker->marker_id,
                   fmt::format("is at least {:.2f} m from every other marker{}, and these are "
                               "within {:.2f} m of each other",
                               nearest_m, ids_of_part.empty() ? "" : " of its part", extent_m) +
                       SeenText(*marker));
  }
}

}  // namespace

std::vector<Contradiction> FindContradictions(const Layout& layout,
                                              const std::vector<PlacedMarker>& markers) {
  Evidence evidence;
  for (const PlacedMarker& marker : markers) evidence.markers.emplace(marker.marker_id, &marker);
  if (evidence.markers.empty()) return {};
  DecideBetweenRivals(layout, &evidence);
  for (const LayoutPart& part : layout.parts) {
    while (DropStrayMarkers(part, &evidence)) {
    }
  }
  if (!layout.HasMarkers() && !evidence.markers.empty()) DropFarMarkers({}, {}, &evidence);
  for (const LayoutPart& part : layout.parts) {
    if (evidence.markers.empty()) break;
    DropFarMarkers(MarkerIds(part), JudgeByLines(part, evidence.markers), &evidence);
  }
  std::vector<Contradiction> contradictions;
  for (const auto& [id, reason] : evidence.reasons) contradictions.push_back({id, reason});
  return contradictions;
}

}  // namespace velamap
