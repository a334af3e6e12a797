#include "workflows/proposal/line_comparison.h"

#include <algorithm>
#include <iterator>
#include <set>

#include <fmt/format.h>

namespace velamap {
namespace {

std::size_t PlaceOf(const Ids& ids, int id) {
  return static_cast<std::size_t>(std::find(ids.begin(), ids.end(), id) - ids.begin());
}

// The ids that `of` holds as well, in the order of `ids`.
Ids Common(const Ids& ids, const Ids& of) {
  Ids common;
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(common),
               [&of](int id) { return Contains(of, id); });
  return common;
}

// The longest subsequence of `ids` in the order of `row`, which holds them all.
Ids LongestInOrder(const Ids& ids, const Ids& row) {
  std::vector<std::size_t> length(ids.size(), 1), previous(ids.size(), ids.size());
  std::size_t last = 0;
  for (std::size_t j = 0; j < ids.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (PlaceOf(row, ids[i]) > PlaceOf(row, ids[j]) || length[i] + 1 <= length[j]) continue;
      length[j] = length[i] + 1;
      previous[j] = i;
    }
    if (length[j] > length[last]) last = j;
  }
  Ids in_order;
  for (std::size_t j = last; j < ids.size(); j = previous[j]) in_order.push_back(ids[j]);
  std::reverse(in_order.begin(), in_order.end());
  return in_order;
}

// Whether more pairs of `ids` stand in the order of `row` than against it.
bool RunsWith(const Ids& ids, const Ids& row) {
  int balance = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t j = i + 1; j < ids.size(); ++j) {
      balance += PlaceOf(row, ids[i]) < PlaceOf(row, ids[j]) ? 1 : -1;
    }
  }
  return balance >= 0;
}

// The line on which the layout has the marker; null for none.
const ComparedLine* LineOf(const std::vector<ComparedLine>& lines, int id, bool is_vertical) {
  for (const ComparedLine& line : lines) {
    if (line.is_vertical == is_vertical && Contains(line.given, id)) return &line;
  }
  return nullptr;
}

void Match(const std::vector<Ids>& rows, const Ids& seen, std::vector<ComparedLine>* lines) {
  struct Candidate {
    std::size_t num_common, line_idx, row_idx;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const Ids& given = (*lines)[i].given;
    const std::size_t num_seen = Common(given, seen).size();
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const std::size_t num_common = Common(given, rows[j]).size();
      if (num_common < 2 || 2 * num_common < num_seen) continue;
      candidates.push_back({num_common, i, j});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.num_common > b.num_common; });
  std::set<std::size_t> taken;
  for (const Candidate& candidate : candidates) {
    ComparedLine& line = (*lines)[candidate.line_idx];
    if (!line.row.empty() || !taken.insert(candidate.row_idx).second) continue;
    line.row = rows[candidate.row_idx];
    line.is_reversed = !RunsWith(Common(line.given, line.row), line.row);
    if (line.is_reversed) std::reverse(line.row.begin(), line.row.end());
  }
}

// A layout may list the marker at a crossing on only one of the two lines. If it lists another
// marker of the crossing line there, that one is wrong.
void SettleCrossings(const std::vector<ComparedLine>& lines, ComparedLine* line) {
  Ids row;
  for (const int id : line->row) {
    const ComparedLine* crossing = LineOf(lines, id, !line->is_vertical);
    if (Contains(line->given, id) || crossing == nullptr || crossing->part != line->part ||
        LineOf(lines, id, line->is_vertical) != nullptr) {
      row.push_back(id);
      continue;
    }
    const auto replaced = std::find_if(line->given.begin(), line->given.end(), [&](int other) {
      return Contains(crossing->given, other) && !Contains(line->row, other);
    });
    if (replaced == line->given.end()) continue;
    line->replaced.push_back(*replaced);
    row.push_back(id);
  }
  line->row = std::move(row);
}

// With two lines, either may be the wrong one.
bool RunsAgainstOthers(const std::vector<ComparedLine>& lines, const ComparedLine& line) {
  constexpr int kMinLines = 3;
  int num = 0, num_reversed = 0;
  for (const ComparedLine& other : lines) {
    if (other.part != line.part || other.is_vertical != line.is_vertical || other.row.empty()) {
      continue;
    }
    ++num;
    num_reversed += other.is_reversed;
  }
  if (line.row.empty() || num < kMinLines || 2 * num_reversed == num) return false;
  return line.is_reversed != (2 * num_reversed > num);
}

std::string Between(const Ids& row, int id) {
  const std::size_t place = PlaceOf(row, id);
  if (place == 0) return fmt::format("before marker {}", row[1]);
  if (place + 1 == row.size()) return fmt::format("after marker {}", row[place - 1]);
  return fmt::format("between markers {} and {}", row[place - 1], row[place + 1]);
}

// The marker beside `id` in `common` that stands beside it in the opposite order; -1 for none.
int SwappedNeighbor(const Ids& common, const Ids& row, int id) {
  const std::size_t place = PlaceOf(common, id), in_row = PlaceOf(row, id);
  if (place > 0 && PlaceOf(row, common[place - 1]) == in_row + 1) return common[place - 1];
  const bool is_last = place + 1 == common.size();
  if (!is_last && PlaceOf(row, common[place + 1]) + 1 == in_row) return common[place + 1];
  return -1;
}

std::vector<std::string> DescribeOrder(const ComparedLine& line) {
  std::vector<std::string> texts;
  const Ids common = Common(line.given, line.row);
  const Ids in_order = LongestInOrder(common, line.row);
  for (const int id : common) {
    if (Contains(in_order, id)) continue;
    const int swapped = SwappedNeighbor(common, line.row, id);
    texts.push_back(swapped >= 0
                        ? fmt::format("line {}: markers {} and {} are in the opposite order",
                                      line.line->name, std::min(id, swapped), std::max(id, swapped))
                        : fmt::format("line {}: marker {} stands {}", line.line->name, id,
                                      Between(line.row, id)));
  }
  return texts;
}

// Where the layout has a marker that stands on `line`.
std::string GivenPlace(const std::vector<ComparedLine>& lines, const Layout& layout,
                       const ComparedLine& line, int id) {
  const ComparedLine* other = LineOf(lines, id, line.is_vertical);
  if (other != nullptr) return "the layout has it on line " + other->line->name;
  const std::string part = PartOfMarker(layout, id);
  if (part.empty()) return "the layout does not name it";
  return fmt::format("the layout has it on {}, on no {} line", part,
                     line.is_vertical ? "vertical" : "horizontal");
}

// Markers of `line` that stand on another line, on which the layout lists them as well.
std::vector<std::string> DescribeTwice(const std::vector<ComparedLine>& lines,
                                       const ComparedLine& line) {
  std::vector<std::string> texts;
  for (const int id : line.given) {
    if (Contains(line.row, id)) continue;
    for (const ComparedLine& other : lines) {
      if (&other == &line || other.is_vertical != line.is_vertical || !Contains(other.row, id) ||
          !Contains(other.given, id)) {
        continue;
      }
      texts.push_back(
          fmt::format("line {}: marker {} stands on line {} only, and the layout has it on both",
                      line.line->name, id, other.line->name));
    }
  }
  return texts;
}

}  // namespace

bool Contains(const Ids& ids, int id) { return std::find(ids.begin(), ids.end(), id) != ids.end(); }

std::vector<ComparedLine> CompareLines(const std::vector<Ids>& rows, const Ids& seen,
                                       std::vector<LayoutPart>* parts) {
  std::vector<ComparedLine> lines;
  for (LayoutPart& part : *parts) {
    for (auto* of_kind : {&part.horizontal, &part.vertical}) {
      for (MarkerLine& line : *of_kind) {
        lines.push_back({&line, &part, of_kind == &part.vertical, line.marker_ids, {}, {}});
      }
    }
  }
  Match(rows, seen, &lines);
  for (ComparedLine& line : lines) SettleCrossings(lines, &line);
  for (ComparedLine& line : lines) line.runs_against_others = RunsAgainstOthers(lines, line);
  return lines;
}

std::vector<std::string> DescribeDifferences(const std::vector<ComparedLine>& lines,
                                             const Layout& layout) {
  std::vector<std::string> texts;
  for (const ComparedLine& line : lines) {
    if (!line.runs_against_others) continue;
    texts.push_back(fmt::format(
        "line {}: it runs opposite to most {} lines of its part; list it from marker {} to {}",
        line.line->name, line.is_vertical ? "vertical" : "horizontal", line.row.back(),
        line.row.front()));
  }
  for (const ComparedLine& line : lines) {
    if (line.row.empty()) continue;
    for (std::string& text : DescribeOrder(line)) texts.push_back(std::move(text));
    for (const int id : line.row) {
      if (Contains(line.given, id)) continue;
      texts.push_back(fmt::format("line {}: marker {} stands {}; {}", line.line->name, id,
                                  Between(line.row, id), GivenPlace(lines, layout, line, id)));
    }
    for (std::string& text : DescribeTwice(lines, line)) texts.push_back(std::move(text));
  }
  return texts;
}

}  // namespace velamap
