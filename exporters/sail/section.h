// Sections of a sail: the numbers that a sailmaker reads off a draft stripe, for every horizontal
// line of the layout and at any heights asked for. Definitions with a drawing: README.md of this
// room.
//
// A section is a smoothing spline through the marker centres of a line (section_spline.h), from its
// first to its last whole marker: the markers do not reach the cloth's edges. At a height it is the
// horizontal cut through the curves that run across the lines at equal fractions of their lengths
// (interpolating splines).
//
//   chord direction c: from the first to the last point; up u: z of the frame
//   depth direction d: u x c (unit length), turned to leeward; depth = d . (f - f_first)
//   leeward: the side to which the sail's lines bulge on the whole
//
// Standard deviations are propagated linearly, by central differences of the whole computation with
// the smoothing held, from the joint covariance of the marker centres, else from their own sigmas
// as if independent; where a marker has none there is none.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "exporters/sail/section_spline.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_frame.h"
#include "importer/base/option.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct Estimate {
  double value = 0.0;
  std::optional<double> sigma;  // 1 sigma
};

// Of a marker on its line.
struct SectionMarker {
  int marker_id = 0;
  Eigen::Vector3d x_in_frame_m = Eigen::Vector3d::Zero();
  double residual_m = 0.0;  // depth of the marker minus that of the curve at its chord length
};

struct Section {
  std::string part;
  std::string name;  // of the line, or "z=2.5" (m) of a height
  bool is_line = true;
  double height_m = 0.0;  // of the middle of the chord
  Estimate chord_m;
  Estimate camber;                         // largest depth / chord; negative if to windward
  std::optional<Estimate> draft_position;  // its place along the chord / chord, from the luff;
                                           // nothing below a camber of 0.1 %
  Estimate entry_angle_deg;  // between chord and curve at the luff, positive to leeward
  Estimate exit_angle_deg;   // the same at the leech, positive where the curve comes back
  Estimate twist_deg;  // of the chord, about up, against `twist_reference`; positive to leeward
  SpaceCurve curve;
  Eigen::Vector3d chord_direction = Eigen::Vector3d::UnitX();  // unit
  Eigen::Vector3d depth_direction = Eigen::Vector3d::UnitY();  // unit, horizontal, to leeward
  // Of a line; empty and 0 for a height.
  std::vector<SectionMarker> markers;
  double num_effective_parameters = 0.0;
};

struct MissingSection {
  std::string part;
  std::string name;
  std::string reason;
};

// By part in the layout's order; within it from the lowest up.
struct SectionReport {
  std::vector<Section> sections;
  std::vector<MissingSection> missing;
  // What holds for more than one section: why there are none at all, sections that cross, a boom
  // that is not there.
  std::vector<std::string> notes;
  std::string twist_reference;  // "boom" or "lowest section"
};

struct SectionOptions {
  std::vector<double> heights_m;  // of sections besides the lines, z in the frame; finite
  int min_markers = 4;            // whole ones on a line

  void Check() const;  // throws InputError that names the option
};

OptionGroup DescribeOptions(SectionOptions* options);

// `shape` and `covariance` (null: none) are in `frame`: MoveShape and RotateCovariance come first.
// Throws InputError for bad options only; what cannot be computed is in the report.
SectionReport ComputeSections(const MarkerShape& shape, const ShapeFrame& frame,
                              const Layout& layout, const PointCovariance* covariance,
                              const SectionOptions& options = {});

// A point of the profile, seen along the sail: chordwise and depth from the first point, m.
struct ProfilePoint {
  Eigen::Vector3d x_in_frame_m = Eigen::Vector3d::Zero();
  double chordwise_m = 0.0;
  double depth_m = 0.0;
};

// Points at equal steps of the curve's parameter, both ends included; at least two.
std::vector<ProfilePoint> SampleProfile(const Section& section, int num_points);
ProfilePoint ProfilePointOf(const Section& section, const Eigen::Vector3d& x_in_frame_m);

}  // namespace velamap
