// Differences of the section numbers of two shapes: camber, draft, twist and so on, by section.

#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "exporters/compare/shape_deviation.h"
#include "exporters/sail/section.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

struct SectionDifference {
  std::string part;
  std::string section;  // name of the line or the height
  std::string number;   // chord_mm, camber_percent, draft_position_percent, entry_angle_deg,
                        // exit_angle_deg, twist_deg
  double value = 0.0;   // of the shape
  double reference = 0.0;
  std::optional<double> sigma;         // of value - reference, whose errors are independent
  std::optional<double> significance;  // (value - reference) / sigma

  double Difference() const { return value - reference; }
  bool IsSignificant() const {
    return significance && std::abs(*significance) > kSignificantSigmas;
  }
};

struct SectionComparison {
  std::string frame_name;  // of the sections: the reference's, by ChooseFrame()
  Rigid3 frame_from_reference;
  // Up of that frame (ShapeFrame::up_in_frame), in the frame of the reference.
  std::optional<Eigen::Vector3d> up_in_reference;
  SectionReport of_shape, of_reference;  // in that frame
  std::vector<SectionDifference> differences;
  // Sections that one of the shapes lacks, with the reason; sections with too few common markers,
  // and twists, that cannot be compared.
  std::vector<std::string> notes;
};

// Null without such a section.
const Section* FindSection(const SectionReport& report, const std::string& part,
                           const std::string& name);

// Cuts both shapes in the frame of the reference after `alignment`, so that a change of height or
// heading of the whole sail does not change a section. An empty `part` means all parts.
SectionComparison CompareSections(const UncertainShape& shape, const UncertainShape& reference,
                                  const Alignment& alignment, const Layout& layout,
                                  const std::string& part);

// The whole markers over the surface, moved along its normal by their distance from it, with the
// sigma of the surface: where the same markers would be on a sail of exactly this shape. In the
// frame of the surface. `deviation` comes from CompareWithMesh().
MarkerShape MarkersOnSurface(const ShapeDeviation& deviation);

// Cuts the design through the markers on its surface, as if the same markers stuck to a sail of
// exactly this shape. Markers that are not over the surface are missing.
SectionComparison CompareSectionsOfDesign(const UncertainShape& shape,
                                          const ShapeDeviation& deviation, const Layout& layout,
                                          const std::string& part);

}  // namespace velamap
