#include "workflows/proposal/layout_proposal.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/geometry/units.h"
#include "importer/text/id_ranges.h"
#include "workflows/proposal/marker_groups.h"

namespace velamap {
namespace {

// Rows of one direction do not cross. Rows of the squares of a chessboard do: its diagonals are as
// horizontal as they are vertical.
bool AreCrossing(const std::vector<std::vector<int>>& rows) {
  std::set<int> ids;
  for (const std::vector<int>& row : rows) {
    for (const int id : row) {
      if (!ids.insert(id).second) return true;
    }
  }
  return false;
}

bool LinesCross(const RowGroup& rows) {
  return AreCrossing(rows.horizontal) || AreCrossing(rows.vertical);
}

bool HasLines(const RowGroup& rows) { return rows.horizontal.size() >= 2 && !LinesCross(rows); }

std::vector<MarkerLine> Named(char letter, std::vector<std::vector<int>> rows) {
  std::vector<MarkerLine> lines;
  for (std::vector<int>& row : rows) {
    lines.push_back({fmt::format("{}{}", letter, lines.size() + 1), std::move(row)});
  }
  return lines;
}

// Whether the rows end at the luff on their right. The luff is the straighter edge: the rows begin
// above each other there, and become shorter along the leech.
bool IsLuffOnTheRight(const std::string& part, const RowGroup& rows,
                      std::vector<std::string>* notes) {
  constexpr double kCertain = 0.05;  // cosine: 3 degrees
  const double difference = rows.left_slant - rows.right_slant;
  const auto off_deg = [](double slant) { return kDegPerRad * std::asin(std::min(1.0, slant)); };
  const bool is_right = difference > kCertain;
  const std::string side = is_right ? "right" : "left";
  notes->push_back(
      std::abs(difference) > kCertain
          ? fmt::format(
                "{}: the luff is taken to be on the {}, where the lines begin above each other "
                "({:.0f} degrees off, {:.0f} at the other end)",
                part, side, off_deg(is_right ? rows.right_slant : rows.left_slant),
                off_deg(is_right ? rows.left_slant : rows.right_slant))
          : fmt::format(
                "{}: NOT SURE which end of the lines is the luff: both edges are alike, and it "
                "is taken to be on the left; if not, reverse every horizontal line",
                part));
  return is_right;
}

LayoutPart PartWithLines(const std::string& name, const RowGroup& rows,
                         std::vector<std::string>* notes) {
  LayoutPart part;
  part.name = name;
  part.horizontal = Named('h', rows.horizontal);
  part.vertical = Named('v', rows.vertical);
  part.marker_ids = rows.others;
  if (IsLuffOnTheRight(name, rows, notes)) {
    for (MarkerLine& line : part.horizontal) {
      std::reverse(line.marker_ids.begin(), line.marker_ids.end());
    }
  }
  if (!rows.knows_up) {
    notes->push_back(fmt::format(
        "{}: NOT SURE which way is up: the markers are turned relative to each other, and the "
        "longest line is taken to be horizontal; check the directions of all lines",
        name));
  }
  if (rows.is_joined_by_likeness) {
    notes->push_back(
        fmt::format("{}: NOT SURE whether all its lines are on one part: they are parallel and "
                    "equally spaced, but no vertical line joins them",
                    name));
  }
  if (!rows.others.empty()) {
    notes->push_back(fmt::format("{}: markers {} are near its lines but on none of them", name,
                                 IdRanges(rows.others)));
  }
  return part;
}

LayoutPart RigidPart(const std::string& name, const RowGroup& rows) {
  LayoutPart part;
  part.name = name;
  part.rigid = true;
  part.marker_ids = rows.MarkerIds();
  return part;
}

void NoteFace(const std::string& name, const FacePlane& plane, std::vector<std::string>* notes) {
  notes->push_back(
      fmt::format("{}: its markers lie in one plane to {:.2g} mm RMS, and others of the same body "
                  "in planes that are tilted relative to it; it is a rigid part without lines",
                  name, kMmPerM * plane.rms_m));
}

void NoteRigidPart(const std::string& name, const RowGroup& rows, bool is_seen_to_move,
                   std::vector<std::string>* notes) {
  if (LinesCross(rows)) {
    notes->push_back(fmt::format(
        "{}: NOT SURE of its lines: they cross others of the same direction, and none is written",
        name));
  }
  notes->push_back(
      is_seen_to_move
          ? fmt::format("{}: its markers keep their places and move relative to the largest part",
                        name)
          : fmt::format(
                "{}: NOT SURE whether it is a rigid part of its own: it has fewer "
                "than two clear lines, and did not move relative to the others in this clip",
                name));
}

// The markers of one printed length, where the layout has another one.
struct OtherLength {
  std::vector<int> marker_ids;
  double length_m = 0.0, sigma_m = 0.0;
};

// Rounded to millimetres, tenths or hundredths, whichever first agrees with the measurement,
// because the length of a print is a round number only if the printer keeps to it.
double RoundedLength(const OtherLength& other) {
  constexpr double kNumSigmas = 2.0;
  const auto rounded_m = [&](double steps_per_m) {
    return std::round(other.length_m * steps_per_m) / steps_per_m;
  };
  for (const double steps_per_m : {1e3, 1e4, 1e5}) {
    const double length_m = rounded_m(steps_per_m);
    const bool agrees = std::abs(length_m - other.length_m) <= kNumSigmas * other.sigma_m;
    if (agrees && length_m > 0) return length_m;
  }
  return rounded_m(1e6);
}

std::vector<OtherLength> FindOtherLengths(const ClipMap& map, const Layout& layout) {
  // Smaller differences come from the print: the audit of the scale judges them.
  constexpr double kNumSigmas = 4.0, kLeast = 0.02, kSameLength = 1.04;
  std::vector<std::pair<double, int>> wrong;  // measured length, id
  for (const auto& [marker_id, side] : map.sides) {
    const double length_m = MarkerLength(layout, marker_id);
    const double error_m = std::abs(side.length_m - length_m);
    if (error_m > std::max(kNumSigmas * side.sigma_m, kLeast * length_m)) {
      wrong.emplace_back(side.length_m, marker_id);
    }
  }
  std::sort(wrong.begin(), wrong.end());
  std::vector<OtherLength> others;
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    if (i == 0 || wrong[i].first > kSameLength * wrong[i - 1].first) others.emplace_back();
    others.back().marker_ids.push_back(wrong[i].second);
  }
  for (OtherLength& other : others) {
    double weights = 0.0, sum_m = 0.0;
    for (const int marker_id : other.marker_ids) {
      const MarkerSide& side = map.sides.at(marker_id);
      const double weight = 1.0 / std::max(side.sigma_m * side.sigma_m, 1e-12);
      weights += weight;
      sum_m += weight * side.length_m;
    }
    other.length_m = sum_m / weights;
    other.sigma_m = std::sqrt(1.0 / weights);
    std::sort(other.marker_ids.begin(), other.marker_ids.end());
  }
  return others;
}

}  // namespace

void NoteLeftOut(const ClipMap& map, const Layout& layout, std::vector<std::string>* notes) {
  std::map<std::string, std::vector<int>> ids_by_reason;
  for (const auto& [marker_id, reason] : map.left_out) {
    if (PartOfMarker(layout, marker_id).empty()) ids_by_reason[reason].push_back(marker_id);
  }
  for (const auto& [reason, ids] : ids_by_reason) {
    notes->push_back(fmt::format("left out, NOT SURE whether they are there: markers {}: {}",
                                 IdRanges(ids), reason));
  }
}

void CorrectLengths(const ClipMap& map, LayoutProposal* proposal) {
  Layout& layout = proposal->layout;
  for (const OtherLength& other : FindOtherLengths(map, layout)) {
    const double length_m = RoundedLength(other);
    const std::string measured =
        fmt::format("{:.2f} +- {:.2f} mm", kMmPerM * other.length_m, kMmPerM * other.sigma_m);
    for (const int marker_id : other.marker_ids) {
      proposal->contradictions.push_back(fmt::format(
          "marker {} is {:.1f} mm long instead of {:g} mm, as measured relative to the others",
          marker_id, kMmPerM * map.sides.at(marker_id).length_m,
          kMmPerM * MarkerLength(layout, marker_id)));
      if (length_m == layout.marker_length_m) {
        layout.marker_lengths_m.erase(marker_id);
      } else {
        layout.marker_lengths_m[marker_id] = length_m;
      }
    }
    proposal->notes.push_back(
        fmt::format("markers {}: measured as {} long, provided that most other markers have the "
                    "given length; the layout now says {:g} mm",
                    IdRanges(other.marker_ids), measured, kMmPerM * length_m));
  }
}

LayoutProposal ProposeLayout(const ClipMap& map, const Layout& known) {
  LayoutProposal proposal;
  proposal.layout = known;
  CorrectLengths(map, &proposal);
  proposal.contradictions.clear();  // nobody has said how long each marker is
  std::vector<LayoutPart>& parts = proposal.layout.parts;
  int num_with_lines = 0, num_rigid = 0, num_faces = 0;
  const std::vector<MarkerGroup> groups = FindMarkerGroups(map);
  const std::map<std::size_t, FacePlane> faces = FindFaces(map, groups);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const MarkerGroup& group = groups[i];
    const auto name = [](const std::string& word, int number) {
      return number == 1 ? word : fmt::format("{}{}", word, number);
    };
    if (const auto face = faces.find(i); face != faces.end()) {
      parts.push_back(RigidPart(name("face", ++num_faces), group.rows));
      NoteFace(parts.back().name, face->second, &proposal.notes);
    } else if (HasLines(group.rows)) {
      parts.push_back(PartWithLines(name("sail", ++num_with_lines), group.rows, &proposal.notes));
    } else {
      parts.push_back(RigidPart(name("part", ++num_rigid), group.rows));
      NoteRigidPart(parts.back().name, group.rows, group.body_idx > 0, &proposal.notes);
    }
  }
  NoteLeftOut(map, {}, &proposal.notes);
  return proposal;
}

}  // namespace velamap
