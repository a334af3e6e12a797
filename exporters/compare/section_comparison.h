// How the section numbers of two shapes differ: camber, draft, twist and so on, line by line.

#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "exporters/compare/shape_comparison.h"
#include "exporters/sail/section.h"
#include "importer/layout/layout.h"

namespace velamap {

struct SectionDifference {
  std::string part;
  std::string section;  // name of the line or of the height
  std::string number;   // chord_mm, camber_percent, draft_position_percent, entry_angle_deg,
                        // exit_angle_deg, twist_deg
  double value = 0.0;   // of the shape
  double reference = 0.0;
  std::optional<double> sigma;         // of value - reference; both are independent
  std::optional<double> significance;  // (value - reference) / sigma

  double Difference() const { return value - reference; }
  bool IsSignificant() const {
    return significance && std::abs(*significance) > kSignificantSigmas;
  }
};

struct SectionComparison {
  std::string frame_name;  // in which both were cut: that of the reference, by ChooseFrame()
  std::vector<SectionDifference> differences;
  std::vector<std::string>
      notes;  // sections that only one has, and why; twists that do not compare
};

// Both shapes are cut in one frame, the reference's, after `alignment`: a change of height or
// heading of the whole sail is no change of a section.
SectionComparison CompareSections(const UncertainShape& shape, const UncertainShape& reference,
                                  const Alignment& alignment, const Layout& layout,
                                  const SectionOptions& options = {});

}  // namespace velamap
