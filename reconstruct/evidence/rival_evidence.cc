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

// Two markers that claim the same place. At least as many images show the first as the second.
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
      "a misread id: it is where marker {} is, seen there in {} images and "
      "marker {} in {}",
      rival.marker_id, marker.num_seen, rival.marker_id, rival.num_seen);
}

// The votes on a marker by the next two undisputed markers on each side, on all of its lines.
struct LineVotes {
  int num_asked = 0;
  int num_for = 0;
  // Number of places from the marker to the nearest marker that votes for it. A near marker is less
  // likely to agree by chance.
  double smallest_gap = std::numeric_limits<double>::infinity();

  bool HasMajority() const { return 2 * num_for > num_asked; }
};

// Whether the distance between two markers of a line is plausible: no longer than the cloth between
// them, and not so short that the line would be folded, as it seems to be if some of its ids are
// misread.
bool FitOnLine(const LinePoint& a, const LinePoint& b, double step_m) {
  constexpr double kFolded = 0.5;
  const bool a_is_first = a.place_on_line < b.place_on_line;
  return AreWithinSteps(a_is_first ? a : b, a_is_first ? b : a, step_m) &&
         (a.x_in_shape_m - b.x_in_shape_m).norm() >
             kFolded * step_m * std::abs(a.place_on_line - b.place_on_line);
}

void AddVotes(const JudgedLine& line, double step_m, const std::set<int>& disputed_ids,
              const PlacedMarker& marker, LineVotes* votes) {
  constexpr int kNumOnEachSide = 2;
  const auto on_line = std::find(line.markers.begin(), line.markers.end(), &marker);
  if (on_line == line.markers.end()) return;
  const auto idx = static_cast<int>(on_line - line.markers.begin());
  const LinePoint& point = line.points[static_cast<std::size_t>(idx)];
  for (const int direction : {-1, 1}) {
    int num_asked = 0;
    for (int i = idx + direction;
         i >= 0 && i < static_cast<int>(line.points.size()) && num_asked < kNumOnEachSide;
         i += direction) {
      const auto other_idx = static_cast<std::size_t>(i);
      if (disputed_ids.count(line.markers[other_idx]->marker_id) > 0) continue;
      ++num_asked;
      ++votes->num_asked;
      const LinePoint& other = line.points[other_idx];
      if (!FitOnLine(point, other, step_m)) continue;
      ++votes->num_for;
      const double gap = std::abs(other.place_on_line - point.place_on_line);
      votes->smallest_gap = std::min(votes->smallest_gap, gap);
    }
  }
}

LineVotes VotesFor(const std::vector<std::vector<JudgedLine>>& lines_of_part,
                   const std::set<int>& disputed_ids, const PlacedMarker& marker) {
  LineVotes votes;
  for (const std::vector<JudgedLine>& lines : lines_of_part) {
    const std::optional<double> step_of_part_m = StepOfPart(lines);
    for (const JudgedLine& line : lines) {
      AddVotes(line, StepOfLine(line, step_of_part_m), disputed_ids, marker, &votes);
    }
  }
  return votes;
}

// Whether the lines support a marker rather than its rival for the same place. They do if only this
// marker has a majority of its votes or, if the majorities do not decide, if its nearest vote is at
// most half as far away as that of the rival. A rival that is on no line cannot be contradicted by
// one.
bool BelongsRatherThan(const LineVotes& votes, const LineVotes& of_rival) {
  constexpr double kMuchNearer = 0.5;
  if (votes.num_for == 0 || of_rival.num_asked == 0) return false;
  if (votes.HasMajority() != of_rival.HasMajority()) return votes.HasMajority();
  return votes.smallest_gap <= kMuchNearer * of_rival.smallest_gap;
}

// Drops each rival that the layout does not support if it supports the other one of the pair.
// Disputed markers have no vote, because a whole line may be misread. A marker that has been
// dropped has no rivals any more. Returns whether any marker was dropped.
bool DropRivalsByLayout(const Layout& layout, const std::vector<RivalPair>& pairs,
                        Evidence* evidence) {
  std::set<int> disputed_ids;
  for (const auto& [a, b] : pairs) disputed_ids.insert({a->marker_id, b->marker_id});
  std::vector<std::vector<JudgedLine>> lines_of_part;
  for (const LayoutPart& part : layout.parts) {
    lines_of_part.push_back(LinesOf(part, evidence->markers));
  }
  bool changed = false;
  for (const auto& [often, seldom] : pairs) {
    if (evidence->reasons.count(often->marker_id) + evidence->reasons.count(seldom->marker_id) >
        0) {
      continue;
    }
    const LineVotes for_often = VotesFor(lines_of_part, disputed_ids, *often);
    const LineVotes for_seldom = VotesFor(lines_of_part, disputed_ids, *seldom);
    const bool often_belongs = BelongsRatherThan(for_often, for_seldom);
    if (!often_belongs && !BelongsRatherThan(for_seldom, for_often)) continue;
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

// Takes the pair whose numbers of images differ most and drops the marker that fewer images show,
// or both markers if the numbers are similar.
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
