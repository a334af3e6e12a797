#include "reconstruct/evidence/rival_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace velamap {
namespace {

// Two markers that claim one place, the one that fewer images see second.
using RivalPair = std::pair<const PlacedMarker*, const PlacedMarker*>;

std::vector<RivalPair> RivalPairs(const MarkersById& markers) {
  std::set<std::pair<int, int>> pairs;
  for (const auto& [id, marker] : markers) {
    for (const int rival_id : marker->rival_ids) {
      if (markers.count(rival_id) > 0)
        pairs.emplace(std::min(id, rival_id), std::max(id, rival_id));
    }
  }
  std::vector<RivalPair> rivals;
  for (const auto& [a_id, b_id] : pairs) {
    const PlacedMarker *a = markers.at(a_id), *b = markers.at(b_id);
    if (a->num_seen < b->num_seen) std::swap(a, b);
    rivals.emplace_back(a, b);
  }
  return rivals;
}

std::string MisreadText(const PlacedMarker& marker, const PlacedMarker& rival) {
  return fmt::format(
      "a misread id: it stands where marker {} stands, seen there in {} images and "
      "marker {} in {}",
      rival.marker_id, marker.num_seen, rival.marker_id, rival.num_seen);
}

// How near on its lines a marker is to one that is where the cloth can have it, in places: the
// smallest such gap to the next two undisputed markers on each side. The nearer, the less is it by
// chance. Infinite where no line confirms the marker.
double ConfirmedWithin(const std::vector<JudgedLine>& lines, const std::set<int>& disputed_ids,
                       const PlacedMarker& marker) {
  constexpr int kNumOnEachSide = 2;
  const std::optional<double> step_of_part_m = StepOfPart(lines);
  double smallest_gap = std::numeric_limits<double>::infinity();
  for (const JudgedLine& line : lines) {
    const auto on_line = std::find(line.markers.begin(), line.markers.end(), &marker);
    if (on_line == line.markers.end()) continue;
    const auto idx = static_cast<int>(on_line - line.markers.begin());
    const LinePoint& point = line.points[static_cast<std::size_t>(idx)];
    const double step_m = StepOfLine(line, step_of_part_m);
    for (const int direction : {-1, 1}) {
      int num_asked = 0;
      for (int i = idx + direction;
           i >= 0 && i < static_cast<int>(line.points.size()) && num_asked < kNumOnEachSide;
           i += direction) {
        const auto other_idx = static_cast<std::size_t>(i);
        if (disputed_ids.count(line.markers[other_idx]->marker_id) > 0) continue;
        ++num_asked;
        const LinePoint& other = line.points[other_idx];
        const bool holds = direction < 0 ? AreAsFarAsTheLineSays(other, point, step_m)
                                         : AreAsFarAsTheLineSays(point, other, step_m);
        const double gap = std::abs(other.place_on_line - point.place_on_line);
        if (holds) smallest_gap = std::min(smallest_gap, gap);
      }
    }
  }
  return smallest_gap;
}

// Leaves out the rivals that the layout does not confirm where it confirms the other one. Disputed
// markers confirm nobody: a line may be misread as a whole. Returns whether there are any.
bool DropRivalsByLayout(const Layout& layout, const std::vector<RivalPair>& pairs,
                        Evidence* evidence) {
  constexpr double kMuchNearer = 0.5;
  std::set<int> disputed_ids;
  for (const auto& [a, b] : pairs) disputed_ids.insert({a->marker_id, b->marker_id});
  std::vector<std::vector<JudgedLine>> lines_of_part;
  for (const LayoutPart& part : layout.parts) {
    lines_of_part.push_back(LinesOf(part, evidence->markers));
  }
  bool changed = false;
  for (const auto& [often, seldom] : pairs) {
    double often_within = std::numeric_limits<double>::infinity(), seldom_within = often_within;
    for (const auto& lines : lines_of_part) {
      often_within = std::min(often_within, ConfirmedWithin(lines, disputed_ids, *often));
      seldom_within = std::min(seldom_within, ConfirmedWithin(lines, disputed_ids, *seldom));
    }
    if (!std::isfinite(std::min(often_within, seldom_within))) continue;
    const bool often_belongs = often_within <= kMuchNearer * seldom_within;
    const bool seldom_belongs = seldom_within <= kMuchNearer * often_within;
    if (!often_belongs && !seldom_belongs) continue;
    const PlacedMarker &stays = often_belongs ? *often : *seldom,
                       &goes = often_belongs ? *seldom : *often;
    evidence->Drop(goes.marker_id, MisreadText(goes, stays) + ", where the layout has it");
    changed = true;
  }
  return changed;
}

double RatioOfSeen(const RivalPair& pair) {
  return static_cast<double>(pair.second->num_seen) / pair.first->num_seen;
}

// Of the two whose numbers of images differ most, the one with fewer goes; both if they hardly do.
void DropRivalByNumber(const std::vector<RivalPair>& pairs, Evidence* evidence) {
  constexpr double kFew = 0.5;
  const RivalPair& pair = *std::min_element(
      pairs.begin(), pairs.end(),
      [](const RivalPair& a, const RivalPair& b) { return RatioOfSeen(a) < RatioOfSeen(b); });
  const auto& [often, seldom] = pair;
  const bool is_decided = RatioOfSeen(pair) < kFew;
  const std::string decision = is_decided ? "" : ", and nothing decides between them";
  evidence->Drop(seldom->marker_id, MisreadText(*seldom, *often) + decision);
  if (!is_decided) evidence->Drop(often->marker_id, MisreadText(*often, *seldom) + decision);
}

}  // namespace

void DecideBetweenRivals(const Layout& layout, Evidence* evidence) {
  for (auto pairs = RivalPairs(evidence->markers); !pairs.empty();
       pairs = RivalPairs(evidence->markers)) {
    if (!DropRivalsByLayout(layout, pairs, evidence)) DropRivalByNumber(pairs, evidence);
  }
}

}  // namespace velamap
