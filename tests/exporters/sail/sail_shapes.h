// Sails with known sections as marker shapes with layouts.

#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/sail/section.h"
#include "exporters/shape/marker_shape.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

// A section of chord 1 from luff (0, 0) to leech (1, 0) at a fraction of its length: chordwise,
// depth.
using UnitProfile = std::function<Eigen::Vector2d(double fraction)>;

UnitProfile CircularArc(double camber);
// Camber line of the four-digit NACA sections, at equal steps of x.
UnitProfile NacaCamberLine(double camber, double position);

// An upright marker of 100 mm with this centre; z is up.
ShapeMarker UprightMarker(int marker_id, const std::string& part, const Eigen::Vector3d& center_m);

struct SailLine {
  double height_m = 0.0;
  double chord_m = 1.0;
  double twist_deg = 0.0;  // to +y
  UnitProfile profile;
};

struct Sail {
  MarkerShape shape;
  Layout layout;
};

// Part "sail": lines h1, h2, ... with markers 100, 101, ..., 200, 201, ...; the luff straight up
// from the origin, the first line's chord along x, bulging to +y (leeward 1) or -y. Vertical line
// v1 holds the luff markers.
Sail MakeSailOfLines(const std::vector<SailLine>& lines, int num_markers, int leeward = 1);

// Three lines of circular arcs whose chord, camber and twist change with height.
Sail ExampleSail(int num_markers = 12, int leeward = 1);

// Adds part "hull" as the reference part: upright markers 10, 11, ... at these centres, m.
void AddHull(const std::vector<Eigen::Vector3d>& centers_m, Sail* sail);

// Moves corners and centres; sigmas keep their axes.
MarkerShape Moved(const Rigid3& new_from_shape, const MarkerShape& shape);
Rigid3 ArbitraryMotion();

// Moves corners and centre.
void ShiftMarker(int marker_id, const Eigen::Vector3d& shift_m, MarkerShape* shape);
void RemoveMarker(int marker_id, MarkerShape* shape);
void SetSigma(double sigma_m, MarkerShape* shape);

// Sections in the frame that `choice` or the layout gives.
SectionReport SectionsOf(const Sail& sail, const SectionOptions& options = {},
                         const std::optional<FrameChoice>& choice = std::nullopt);

// Chord, camber, draft position (-1 for none), entry and exit angle, twist, twist of
// the leech, girth, height.
std::vector<double> NumbersOf(const Section& section);

}  // namespace velamap
