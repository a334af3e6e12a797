// Sections of a sail: the numbers that a sailmaker reads off a draft stripe, for every horizontal
// line of the layout and at given heights. README.md of this folder defines them with a drawing.
//
// The section of a line is a smoothing spline through its marker centres (section_spline.h) from
// the first to the last whole marker. Where the layout says how far the edges of the cloth are from
// these, it continues to the edges with the curvature that it has at its ends. Centres that
// are means of corners lie inside the bend of the cloth: cloth_places.h moves them. The section
// at a height is the cut at right angles to up through interpolating splines that run across the
// lines at equal fractions of their lengths.
//
//   chord direction c: from the first to the last point; up u: along the luff, whatever the frame
//   depth direction d: u x c (unit length), towards leeward; depth = d . (f - f_first)
//   leeward: the side to which the lines of the sail bulge in total
//
// Standard deviations are propagated linearly from the joint covariance of the marker centres, or
// without one from their sigmas as if independent, by central differences of the whole computation
// at constant smoothing. A section that depends on a marker without a sigma has no sigmas.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/curve/section_spline.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_frame.h"
#include "importer/base/option.h"
#include "importer/base/statistics.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// A marker on its line.
struct SectionMarker {
  int marker_id = 0;
  Eigen::Vector3d x_in_frame_m = Eigen::Vector3d::Zero();
  double residual_m = 0.0;  // depth of the marker minus depth of the curve at its chord length
};

struct Section {
  std::string part;
  std::string name;  // of the line, or "height=2.5" (m) for a height
  bool is_line = true;
  double height_m = 0.0;  // of the middle of the chord
  Estimate chord_m;
  Estimate camber;  // largest depth / chord; negative if to windward
  // Distance of the deepest point from the luff, along the chord, / chord; nothing below a camber
  // of 0.1 %.
  std::optional<Estimate> draft_position;
  Estimate entry_angle_deg;  // between chord and curve at the luff, positive to leeward
  Estimate exit_angle_deg;   // the same at the leech, positive if the curve returns from leeward
  // Angle of the chord about up, from RigNumbers::twist_reference; positive to leeward.
  std::optional<Estimate> twist_deg;
  // Angle about up from the direction in which RigNumbers::reference_section ends at the leech to
  // the direction in which this curve does; positive to leeward.
  std::optional<Estimate> leech_twist_deg;
  Estimate girth_m;  // length of the curve
  SpaceCurve curve;
  Eigen::Vector3d chord_direction = Eigen::Vector3d::UnitX();  // unit
  Eigen::Vector3d depth_direction = Eigen::Vector3d::UnitY();  // unit, across up, to leeward
  // Empty and 0 for a height.
  std::vector<SectionMarker> markers;
  double num_effective_parameters = 0.0;
  // Markers of the layout's line before the first and after the last whole one; for a height, of
  // the lines next to it. Without them, all numbers are those of a shorter chord.
  int num_missing_at_luff = 0, num_missing_at_leech = 0;
  // Whether the curve ends at the edge of the cloth; otherwise it ends at the outer marker.
  bool reaches_luff = false, reaches_leech = false;
};

// "3 markers missing at the luff", or nothing for a section of the whole line.
std::string MissingEndsText(const Section& section);

struct MissingSection {
  std::string part;
  std::string name;
  std::string reason;
  // The layout gives the line too few markers for a section, in this clip and in any other.
  bool is_by_layout = false;
};

// What the markers of a part with lines say about the rig; nothing if they do not determine it.
struct RigNumbers {
  std::string part;
  // Largest distances of the luff from the straight line between its ends, in the plane of that
  // line and the fore-and-aft direction, and across this plane.
  std::optional<Estimate> luff_bend_m;  // positive forwards: bend of the mast
  std::optional<Estimate> luff_sag_m;   // positive to leeward: sag of the forestay
  std::vector<int> luff_marker_ids;     // from foot to head; empty without bend and sag
  // Angle about up from the centre line to the boom or, without one, to the chord of the reference
  // section; positive to leeward. Nothing without a centre line.
  std::optional<Estimate> sheeting_angle_deg;
  // The lowest line that is whole at both ends; empty if every line with a section lacks an end.
  std::string reference_section;
  // What stands for the direction aft, and from what twist counts: "centerline" or "boom" (of the
  // first part with lines), else "lowest section", "section h2" where the reference section is
  // another one, or "none".
  std::string aft_reference, twist_reference;
  // What gives the part's up: "luff"; "lines" without two whole markers of the luff; "z of the
  // frame" where neither does.
  std::string up_reference;
};

// Sections by part in the order of the layout, and from the lowest up within a part.
struct SectionReport {
  std::vector<Section> sections;
  std::vector<MissingSection> missing;
  std::vector<RigNumbers> rigs;  // of parts with sections, in the order of the layout
  // Notes on more than one section: why there are none, sections that cross, a missing boom.
  std::vector<std::string> notes;
};

struct SectionOptions {
  // Of additional sections, along up from the frame's origin; finite.
  std::vector<double> heights_m;
  int min_markers = 4;    // whole markers that a line needs
  std::string part = {};  // the only part of the layout to cut; empty for all

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(SectionOptions* options);

// `shape` and `covariance` (may be null) are in `frame` (MoveShape, RotateCovariance). Throws
// InputError for bad options; the report lists what cannot be computed.
SectionReport ComputeSections(const MarkerShape& shape, const ShapeFrame& frame,
                              const Layout& layout, const PointCovariance* covariance,
                              const SectionOptions& options = {});

// A point of the profile, with its coordinates along chord and depth from the first point, m.
struct ProfilePoint {
  Eigen::Vector3d x_in_frame_m = Eigen::Vector3d::Zero();
  double chordwise_m = 0.0;
  double depth_m = 0.0;
};

// Points at equal steps of the curve's parameter, including both ends; at least two.
std::vector<ProfilePoint> SampleProfile(const Section& section, int num_points);
ProfilePoint ProfilePointOf(const Section& section, const Eigen::Vector3d& x_in_frame_m);

}  // namespace velamap
