// The rows of a surface, from foot to head: the lines of markers, and the edges of foot and head
// where they are given, with u of their points.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/surface/surface.h"

namespace velamap {

struct SurfaceRow {
  std::string name;
  bool is_edge = false;  // foot or head, where they are given
  std::vector<int> marker_ids;
  std::vector<Eigen::Vector3d> points;
  std::vector<double> us;
  double length_m = 0.0;
  // How far the surface continues before the first and after the last point.
  double before_m = 0.0, after_m = 0.0;
};

// The places of the markers of the line that the shape has, from the luff.
std::vector<Eigen::Vector3d> PresentPoints(const SurfaceLine& line);

// Length of a polyline up to each of its points, m.
std::vector<double> ChordLengths(const std::vector<Eigen::Vector3d>& points);

// Mean length of the lines, from the first marker to the last.
double MeanLength(const std::vector<SurfaceLine>& lines);

// The points of an edge, or some of them where they are many, each place once.
std::vector<Eigen::Vector3d> SomePoints(const std::vector<Eigen::Vector3d>& points);

// u is the chord length from the luff over the length of the whole line. A missing marker at the
// end of a line counts with the mean spacing of the line, so that the edge of the surface keeps its
// place. On a given luff or leech, each line gets a point where it meets the smooth curve through
// the points of the edge. Throws DataError for two markers in one place and InputError for an edge
// without a length.
std::vector<SurfaceRow> MakeSurfaceRows(const std::vector<SurfaceLine>& lines,
                                        const SurfaceOptions& options,
                                        std::vector<std::string>* notes);

// Mean distance between two neighbouring rows over their common range of u. Throws DataError if
// they cross or run in opposite directions.
double MeanDistance(const SurfaceRow& lower, const SurfaceRow& upper);

}  // namespace velamap
