// What the figures of a comparison are called: keys and tables for stdout, CSV and JSON. They are
// listed in the README of this room.

#pragma once

#include "exporters/compare/section_comparison.h"
#include "exporters/compare/shape_comparison.h"
#include "exporters/compare/surface_comparison.h"
#include "exporters/formats/metrics_report.h"

namespace velamap {

// Keys of sigmas and significance are there where the sigmas are. Tables parts, lines, and, for the
// files only, markers.
void AddMetrics(const ShapeDeviation& deviation, MetricsReport* report);

// surface_note; table surfaces: part and surface_distance_mm.
void AddMetrics(const SurfaceComparison& comparison, MetricsReport* report);

// section_frame, num_significant_section_numbers, section_note; table section_differences.
void AddMetrics(const SectionComparison& comparison, MetricsReport* report);

}  // namespace velamap
