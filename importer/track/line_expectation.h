// Expects missing markers on the lines of the layout, between and beside those that are found.

#pragma once

#include <vector>

#include "importer/detect/marker_quad.h"
#include "importer/layout/layout.h"

namespace velamap {

// Ids along each line of the layout, horizontal and vertical, and those that a part lists outside
// its lines: these usually stand in a row too, and where they do not, no marker is located there.
std::vector<std::vector<int>> LinesOfLayout(const Layout& layout);

// Expects every marker whose two neighbours on a line are found midway between them, and every
// marker whose next two on one side are found as far beyond these as they are apart. Pairs of
// different orientation and ids that are found twice are ignored.
std::vector<ExpectedMarker> ExpectOnLines(const std::vector<std::vector<int>>& lines,
                                          const std::vector<MarkerQuad>& found);

}  // namespace velamap
