// comparison.html: one file that shows a comparison in any browser without a network, and the
// deflections beside it. It has the style, the tables and the 3D view of the report.

#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "exporters/compare/comparison.h"
#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"

namespace velamap {

struct ComparisonPageInput {
  const std::vector<Comparison>& series;  // at least one
  const MarkerShape* reference;           // null for a design
  const Layout& layout;                   // may be empty
  std::string reference_name = {};
  std::string version = {};                   // of the program
  std::string created = {};                   // date and time; empty for none
  std::optional<double> color_limit_mm = {};  // the distance with the full colour; or the largest
};

void WriteComparisonPage(const ComparisonPageInput& input, std::ostream& out);

// The data of the page, a JSON object in UTF-8 that can be part of an HTML script element. Keys:
//
//   title, version, created, reference, is_design, color_limit_mm, positive_side
//   verdict    text, items, level (bad, check, or empty if the shapes can be compared)
//   frame      name, up, forward
//   shapes     name, alignment_by, residual_mm, turn_deg, scale_percent, num_markers,
//              num_beyond_edge, num_beside, mean_mm, rms_mm, largest_mm, num_with_sigma,
//              num_significant
//   numbers    section, number, unit, reference (of the first shape that has the number; the
//              sections of a design depend on the markers of the shape), values: for each shape
//              value, difference, sigma, is_significant, or null
//   profiles   section, curves: name, own (from the luff along the own chord, mm), placed (from the
//              luff of the reference along its chord, mm); the first one is the reference's
//   markers    id, part, corners, centre (m), distances: for each shape distance_mm, sigma_mm,
//              significance, beside_mm, is_beside, or null
//   surfaces   for each shape vertices (m, on the reference), triangles, distances_mm (null if
//              unknown)
std::string ComparisonJson(const ComparisonPageInput& input);

// Writes the files of the folder: comparison.html and, with deflections, deflection.csv and
// deflection.vts. In a series, deflection.csv holds all shapes, and each shape has its own VTS
// file, such as deflection_trim2.vts. The second part with lines is in deflection_part2.vts.
void WriteComparisonFiles(const ComparisonPageInput& input, const std::filesystem::path& folder);

}  // namespace velamap
