// Expects missing markers on the lines of the layout, between and beside those that are found.

#pragma once

#include <vector>

#include "importer/detect/marker_quad.h"
#include "importer/layout/layout.h"

namespace velamap {

// Ids along each line of the layout, horizontal and vertical, and the ids that a part lists outside
// its lines: these usually form a row too, and where they do not, no marker is located there.
std::vector<std::vector<int>> LinesOfLayout(const Layout& layout);

// Expects a marker midway between its two neighbours on a line if both are found. Otherwise, if the
// next two markers on one side are found, expects it beyond the nearer one at the distance between
// the two. Pairs of different orientation and ids that are found twice are ignored.
std::vector<ExpectedMarker> ExpectOnLines(const std::vector<std::vector<int>>& lines,
                                          const std::vector<MarkerQuad>& found);

}  // namespace velamap
