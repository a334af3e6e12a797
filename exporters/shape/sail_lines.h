// What the layout's lines say of a reconstructed sail: ends, up, aft, and to which side it bulges.
// Only whole markers count; all by their centres, shape frame, m.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"

namespace velamap {

// The marker has to be whole.
Eigen::Vector3d CenterOf(const MarkerShape& shape, int marker_id);

// All ids of the part in the layout's order, lines first, each once.
std::vector<int> MarkersOfPart(const Layout& layout, const std::string& part);

// The first part with horizontal lines; null without any.
const LayoutPart* FirstPartWithLines(const Layout& layout);

struct LineEnds {
  Eigen::Vector3d first, last;
  Eigen::Vector3d Middle() const { return (first + last) / 2; }
};

// The lines of at least two markers of which the first and the last are whole, in order.
std::vector<const MarkerLine*> LinesWithEnds(const MarkerShape& shape,
                                             const std::vector<MarkerLine>& lines);
// Of such a line.
LineEnds EndsOf(const MarkerShape& shape, const MarkerLine& line);

// Unit vector from foot to head of the first part with lines: along its vertical lines, without
// them from its lowest to its highest horizontal line. Markers at the ends may be missing. Nothing
// when the markers do not say it.
std::optional<Eigen::Vector3d> SailUp(const MarkerShape& shape, const Layout& layout);

// Unit vector from luff to leech, mean of the horizontal lines of the same part.
std::optional<Eigen::Vector3d> SailAft(const MarkerShape& shape, const Layout& layout);

// To which side of their chords the horizontal lines bulge along the unit vector: 1 or -1, and 0
// when less than 0.1 % of the chords or without three markers on any line.
int BulgeSide(const MarkerShape& shape, const Layout& layout, const Eigen::Vector3d& direction);

}  // namespace velamap
