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

// Two markers that claim one place. Fewer images see the second one.
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

// The votes on a marker by the next two undisputed markers on each side, over all of its lines.
struct LineVotes {
  int num_asked = 0;
  int num_for = 0;
  // Places between the marker and the nearest vote for it. Near votes are less likely by chance.
  double smallest_gap = std::numeric_limits<double>::infinity();

  bool HasMajority() const { return 2 * num_for > num_asked; }
};

// Whether two markers of a line may be where they are: no farther apart than the cloth allows, and
// not so near that the line would be folded. A line that is misread in part looks folded.
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

// Whether the layout supports one marker, and not the other one, in the place that both claim: most
// votes are for this one, or the votes for the other one come from more than twice as far. A marker
// that is on no line is not contradicted by one.
bool BelongsRatherThan(const LineVotes& votes, const LineVotes& of_rival) {
  constexpr double kMuchNearer = 0.5;
  if (votes.num_for == 0 || of_rival.num_asked == 0) return false;
  if (votes.HasMajority() != of_rival.HasMajority()) return votes.HasMajority();
  return votes.smallest_gap <= kMuchNearer * of_rival.smallest_gap;
}

// Leaves out rivals that the layout does not confirm if it confirms the other one. Disputed markers
// have no vote, because a whole line may be misread. Returns whether any rival is left out.
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

// Takes the pair whose numbers of images differ most and leaves out the marker that fewer images
// see, or both if the numbers hardly differ.
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
