// Where the layout says that markers should be visible: on its lines, between and beside those
// that are found.

#pragma once

#include <vector>

#include "importer/detect/marker_quad.h"
#include "importer/layout/layout.h"

namespace velamap {

// Ids along each line of the layout, horizontal and vertical, and those that a part lists outside
// its lines: most often they stand in a row as well, and where not, none is located there.
std::vector<std::vector<int>> LinesOfLayout(const Layout& layout);

// Of every marker whose two neighbours on a line are found, or the next two on one side of it:
// midway between them, or as far beyond as they are apart; none where the two stand differently.
// An id that is found twice says nothing.
std::vector<ExpectedMarker> ExpectOnLines(const std::vector<std::vector<int>>& lines,
                                          const std::vector<MarkerQuad>& found);

}  // namespace velamap
