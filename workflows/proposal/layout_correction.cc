#include "workflows/proposal/layout_correction.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/text/id_ranges.h"
#include "workflows/proposal/line_comparison.h"
#include "workflows/proposal/marker_groups.h"

namespace velamap {
namespace {

void Remove(int id, Ids* ids) { ids->erase(std::remove(ids->begin(), ids->end(), id), ids->end()); }

// `name`, followed by underscores until none of `others` has that name.
template <typename Named>
std::string UnusedName(std::string name, const std::vector<Named>& others) {
  while (std::any_of(others.begin(), others.end(),
                     [&](const Named& other) { return other.name == name; })) {
    name += "_";
  }
  return name;
}

class Corrector {
 public:
  Corrector(const ClipMap& map, const Layout& given) : map_(map), given_(given) {
    proposal_.layout = given;
    CorrectLengths(map, &proposal_);
    std::vector<Ids> rows;
    for (const MarkerGroup& group : FindMarkerGroups(map)) {
      for (const auto* of_kind : {&group.rows.horizontal, &group.rows.vertical}) {
        rows.insert(rows.end(), of_kind->begin(), of_kind->end());
      }
      groups_.push_back(group.rows);
    }
    for (const ShapePoints& body : map.bodies) {
      for (const auto& [marker_id, points] : body) seen_.push_back(marker_id);
    }
    lines_ = CompareLines(rows, seen_, &proposal_.layout.parts);
  }

  LayoutProposal Correct() {
    for (std::string& text : DescribeDifferences(lines_, given_)) {
      proposal_.contradictions.push_back(std::move(text));
    }
    for (const ComparedLine& line : lines_) WriteLine(line);
    for (const ComparedLine& line : lines_) RemoveFromOtherPlaces(line);
    AddUnnamed();
    RemoveEmptyLines();
    RemoveEmptyParts();
    NoteLeftOut(map_, proposal_.layout, &proposal_.notes);
    return std::move(proposal_);
  }

 private:
  // Whether the row of another line of the kind holds the marker.
  bool StandsElsewhere(int id, const ComparedLine& line) const {
    return std::any_of(lines_.begin(), lines_.end(), [&](const ComparedLine& other) {
      return &other != &line && other.is_vertical == line.is_vertical && Contains(other.row, id);
    });
  }

  // Writes the markers of the row. Those that the clip does not show stay after the ones that
  // precede them in the layout.
  void WriteLine(const ComparedLine& line) {
    Ids ids = line.row, not_found;
    auto place = ids.begin();  // behind the last marker of the layout's line
    for (const int id : line.given) {
      if (Contains(line.replaced, id) || StandsElsewhere(id, line)) continue;
      const auto found = std::find(ids.begin(), ids.end(), id);
      if (found != ids.end()) {
        place = std::next(found);
        continue;
      }
      if (!line.row.empty() && Contains(seen_, id)) not_found.push_back(id);
      place = std::next(ids.insert(place, id));
    }
    if (!not_found.empty()) {
      proposal_.notes.push_back(fmt::format(
          "line {}: NOT SURE of markers {}: they are seen, but not on the line, and stay "
          "where the layout has them",
          line.line->name, IdRanges(not_found)));
    }
    if (line.runs_against_others) std::reverse(ids.begin(), ids.end());
    line.line->marker_ids = std::move(ids);
  }

  // A marker belongs to one part.
  void RemoveFromOtherPlaces(const ComparedLine& line) {
    for (const int id : line.row) {
      for (LayoutPart& part : proposal_.layout.parts) {
        Remove(id, &part.marker_ids);
        if (&part == line.part) continue;
        for (auto* lines : {&part.horizontal, &part.vertical}) {
          for (MarkerLine& other : *lines) Remove(id, &other.marker_ids);
        }
      }
    }
  }

  // The part of most markers of a group; null if the layout names none of them.
  LayoutPart* PartOf(const RowGroup& group) {
    std::map<std::string, int> votes;
    const auto vote = [&](const Ids& ids) {
      for (const int id : ids) {
        const std::string part = PartOfMarker(proposal_.layout, id);
        if (!part.empty()) ++votes[part];
      }
    };
    vote(group.others);
    for (const Ids& row : group.horizontal) vote(row);
    for (const Ids& row : group.vertical) vote(row);
    if (votes.empty()) return nullptr;
    const std::string& name =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        })->first;
    const auto part = std::find_if(proposal_.layout.parts.begin(), proposal_.layout.parts.end(),
                                   [&](const LayoutPart& p) { return p.name == name; });
    return &*part;
  }

  // Adds the markers that the layout does not name: rows of them become lines, others go to the
  // part next to which they stand, or to a new one.
  void AddUnnamed() {
    Ids added_alone;
    for (const RowGroup& group : groups_) {
      LayoutPart* part = PartOf(group);
      Ids unnamed;
      const auto collect = [&](const Ids& ids) {
        for (const int id : ids) {
          if (PartOfMarker(proposal_.layout, id).empty() && !Contains(unnamed, id))
            unnamed.push_back(id);
        }
      };
      for (const Ids& row : group.horizontal) {
        const bool is_new =
            part != nullptr && !part->horizontal.empty() && row.size() >= 3 &&
            std::all_of(row.begin(), row.end(), [&](int id) {
              return PartOfMarker(proposal_.layout, id).empty() || IsOn(part->vertical, id);
            });
        if (is_new) AddLine(row, part);
        collect(row);
      }
      for (const Ids& row : group.vertical) collect(row);
      collect(group.others);
      if (unnamed.empty()) continue;
      proposal_.contradictions.push_back(fmt::format(
          "markers {} are on the object, and the layout does not name them", IdRanges(unnamed)));
      if (part == nullptr) {
        added_alone.insert(added_alone.end(), unnamed.begin(), unnamed.end());
      } else {
        part->marker_ids.insert(part->marker_ids.end(), unnamed.begin(), unnamed.end());
      }
    }
    if (!added_alone.empty()) AddPart(std::move(added_alone));
  }

  // Adds a part of its own for markers that stand with none that the layout names.
  void AddPart(Ids ids) {
    LayoutPart part;
    part.name = UnusedName("unnamed", given_.parts);
    std::sort(ids.begin(), ids.end());
    part.marker_ids = std::move(ids);
    proposal_.notes.push_back(fmt::format("part {}: NOT SURE where its markers belong", part.name));
    proposal_.layout.parts.push_back(std::move(part));
  }

  static bool IsOn(const std::vector<MarkerLine>& lines, int id) {
    return std::any_of(lines.begin(), lines.end(),
                       [id](const MarkerLine& line) { return Contains(line.marker_ids, id); });
  }

  void AddLine(const Ids& row, LayoutPart* part) {
    const std::string name =
        UnusedName(fmt::format("h{}", part->horizontal.size() + 1), part->horizontal);
    part->horizontal.push_back({name, row});
    proposal_.contradictions.push_back(
        fmt::format("markers {} stand on a line that the layout does not name", IdRanges(row)));
    proposal_.notes.push_back(fmt::format(
        "line {}: NOT SURE of its place among the lines and of its direction: it is new", name));
  }

  static bool HaveSameNames(const std::vector<MarkerLine>& a, const std::vector<MarkerLine>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const MarkerLine& x, const MarkerLine& y) { return x.name == y.name; });
  }

  // Also removes edges with a distance for each line if the lines have changed.
  void RemoveEmptyLines() {
    for (std::size_t i = 0; i < given_.parts.size(); ++i) {
      LayoutPart& part = proposal_.layout.parts[i];
      for (auto* lines : {&part.horizontal, &part.vertical}) {
        lines->erase(std::remove_if(lines->begin(), lines->end(),
                                    [](const MarkerLine& line) { return line.marker_ids.empty(); }),
                     lines->end());
      }
      RemoveLostEdges(&part);
      if (HaveSameNames(part.horizontal, given_.parts[i].horizontal)) continue;
      for (ClothEdge* edge : {&part.edges.luff, &part.edges.leech}) {
        if (edge->offsets_m.size() < 2) continue;
        *edge = {};
        proposal_.notes.push_back(fmt::format(
            "{}: the edge with a distance for each line is left out, because the lines changed",
            part.name));
      }
    }
  }

  // Removes an edge whose line or points are no longer in the part, or whose line is no longer an
  // outer one.
  void RemoveLostEdges(LayoutPart* part) {
    const std::set<int> ids = MarkerIds(*part);
    const auto is_in = [](const std::vector<MarkerLine>& lines, const std::string& name) {
      return std::any_of(lines.begin(), lines.end(),
                         [&](const MarkerLine& line) { return line.name == name; });
    };
    const auto is_outer = [&](const std::string& name) {
      return !part->horizontal.empty() &&
             (part->horizontal.front().name == name || part->horizontal.back().name == name);
    };
    ClothEdges& edges = part->edges;
    for (ClothEdge* edge : {&edges.luff, &edges.leech, &edges.foot, &edges.head}) {
      const bool is_side = edge == &edges.luff || edge == &edges.leech;
      const bool lost_line = !edge->line.empty() &&
                             !(is_side ? is_in(part->vertical, edge->line) : is_outer(edge->line));
      const bool lost_point =
          std::any_of(edge->points.begin(), edge->points.end(),
                      [&](const CornerId& point) { return ids.count(point.marker_id) == 0; });
      if (!lost_line && !lost_point) continue;
      *edge = {};
      proposal_.notes.push_back(fmt::format("{}: an edge is left out, because its {} changed",
                                            part->name, lost_line ? "line" : "points"));
    }
  }

  void RemoveEmptyParts() {
    Layout& layout = proposal_.layout;
    const auto empty =
        std::stable_partition(layout.parts.begin(), layout.parts.end(), [](const LayoutPart& part) {
          return !part.horizontal.empty() || !part.vertical.empty() || !part.marker_ids.empty();
        });
    for (auto part = empty; part != layout.parts.end(); ++part) {
      if (layout.reference_part == part->name) layout.reference_part.reset();
    }
    layout.parts.erase(empty, layout.parts.end());
  }

  const ClipMap& map_;
  const Layout& given_;
  LayoutProposal proposal_;
  std::vector<RowGroup> groups_;
  Ids seen_;  // that have a place
  std::vector<ComparedLine> lines_;
};

}  // namespace

LayoutProposal CorrectLayout(const ClipMap& map, const Layout& given) {
  return Corrector(map, given).Correct();
}

}  // namespace velamap
