// Directions of a reconstructed sail from the lines of the layout: ends, up, aft, and the side to
// which the sail bulges. All functions use the centres of whole markers, in the shape frame, m.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"

namespace velamap {

// How far beyond the outer markers curves and surfaces go on to the edge of the cloth, as a share
// of the length that the markers cover. Farther out, a parabola is a guess.
inline constexpr double kMaxReach = 0.5;

// The marker must be whole.
Eigen::Vector3d CenterOf(const MarkerShape& shape, int marker_id);

// Those of the points that belong to whole markers, in order, in the shape frame, m.
std::vector<Eigen::Vector3d> WholePoints(const MarkerShape& shape,
                                         const std::vector<CornerId>& points);

// The points along a luff or leech that the layout names, by a vertical line or one by one.
std::vector<CornerId> PointsAlongSide(const LayoutPart& part, const ClothEdge& edge);

// Each id of the part once, in the order of the layout, lines first.
std::vector<int> MarkersOfPart(const Layout& layout, const std::string& part);

struct LineEnds {
  Eigen::Vector3d first, last;
  Eigen::Vector3d Middle() const { return (first + last) / 2; }
};

// The lines with at least two markers whose first and last markers are whole, in order.
std::vector<const MarkerLine*> LinesWithEnds(const MarkerShape& shape,
                                             const std::vector<MarkerLine>& lines);
// Ends of such a line.
LineEnds EndsOf(const MarkerShape& shape, const MarkerLine& line);

// Unit vector from foot to head of the part: along its vertical lines or, without any, from its
// lowest to its highest horizontal line. Markers at the ends may be missing. Returns nothing if the
// markers do not determine it.
std::optional<Eigen::Vector3d> SailUp(const MarkerShape& shape, const LayoutPart& part);
// The same by the order of the horizontal lines alone, whichever way the vertical ones run.
std::optional<Eigen::Vector3d> LinesUp(const MarkerShape& shape, const LayoutPart& part);
// SailUp() of the first part with horizontal lines.
std::optional<Eigen::Vector3d> SailUp(const MarkerShape& shape, const Layout& layout);

// Whether the direction (of any length) is within 60 degrees of the opposite of `up`, a unit
// vector.
bool PointsDown(const Eigen::Vector3d& direction, const Eigen::Vector3d& up);

// Why the first part with horizontal lines may be listed from head to foot, with the remedy: most
// of its whole markers point down (PointsDown()), by SailUp(). Empty if they do not. This is no
// proof, because markers may also be glued upside down.
std::string DoubtAboutSailUp(const MarkerShape& shape, const Layout& layout);

// Unit vector up the luff: the least-squares line through the first markers, if whole, of the
// horizontal lines of the part. Returns nothing with fewer than two.
std::optional<Eigen::Vector3d> LuffDirection(const MarkerShape& shape, const LayoutPart& part);

// Unit vector from luff to leech, the mean over the horizontal lines of the first part with lines.
std::optional<Eigen::Vector3d> SailAft(const MarkerShape& shape, const Layout& layout);

// The side to which the horizontal lines of the first part with lines bulge from their chords: 1
// along the unit vector `direction`, -1 against it. 0 if their mean depth is below 0.1 % of the
// chords, or if no line has three markers.
int BulgeSide(const MarkerShape& shape, const Layout& layout, const Eigen::Vector3d& direction);

// "2 markers missing at the luff and 1 at the leech" of a line, or nothing for a whole one.
std::string MissingEndsText(int num_at_luff, int num_at_leech);

}  // namespace velamap
