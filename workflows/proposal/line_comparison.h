// The lines of a layout beside the rows on which the markers of a clip stand.

#pragma once

#include <string>
#include <vector>

#include "importer/layout/layout.h"

namespace velamap {

using Ids = std::vector<int>;

bool Contains(const Ids& ids, int id);

struct ComparedLine {
  MarkerLine* line = nullptr;
  LayoutPart* part = nullptr;
  bool is_vertical = false;
  Ids given;  // its markers as the layout has them
  Ids row;    // as they stand in the clip, in the direction of the line; empty: not found there
  // Markers of `given` that are also on a crossing line, where the clip shows another marker of
  // that line.
  Ids replaced;
  bool is_reversed = false;  // the row runs from left to right or up, and the line does not
  // The line runs opposite to most lines of its kind (horizontal or vertical) and part.
  bool runs_against_others = false;
};

// Each line of `parts` gets the row that holds most of its markers, at least half of those that are
// in `seen`. The lines refer to `parts`.
std::vector<ComparedLine> CompareLines(const std::vector<Ids>& rows, const Ids& seen,
                                       std::vector<LayoutPart>* parts);

// Where the lines are wrong, one text each. `layout` has the parts as they were given.
std::vector<std::string> DescribeDifferences(const std::vector<ComparedLine>& lines,
                                             const Layout& layout);

}  // namespace velamap
