// Derivatives of the section numbers with respect to the marker centers, for their sigmas. Private
// to section.cc.

#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "exporters/sail/section_lines.h"
#include "exporters/sail/section_numbers.h"
#include "importer/layout/layout.h"

namespace velamap {

// Common to all sections of one part.
struct PartContext {
  const LayoutPart& part;
  const CenterSet& centers;
  SectionAxes axes;
  PartCurves curves;
};

// Two markers of the boom as indices into the CenterSet, from the mast aft.
struct Boom {
  int first_idx = 0, last_idx = 0;
};

// One row per number, one column per coordinate of the marker centers. NaN if no marker of the
// section has a sigma.
struct NumbersWithGradient {
  SectionNumbers numbers;
  Eigen::MatrixXd gradient;
};

NumbersWithGradient NumbersOfLine(const PartContext& context, const LineCurve& line);
// `cut` is the section at `height_m`.
NumbersWithGradient NumbersOfCut(const PartContext& context, const SpaceCurve& cut,
                                 double height_m);
// The azimuth of the boom; the other numbers are zero.
NumbersWithGradient NumbersOfBoom(const PartContext& context, const Boom& boom);

// Sigma of a number with this gradient; nothing if it depends on a marker without a sigma.
std::optional<double> SigmaOfGradient(const CenterSet& centers,
                                      const Eigen::RowVectorXd& gradient);

// Points of the lines as CutAtHeight takes them.
std::vector<Eigen::Matrix3Xd> SampleLines(const std::vector<LineCurve>& lines);

}  // namespace velamap
