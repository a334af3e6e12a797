// Keys and tables of a comparison for stdout, CSV and JSON. README.md of this folder lists them.

#pragma once

#include "exporters/compare/section_comparison.h"
#include "exporters/compare/shape_deviation.h"
#include "exporters/compare/surface_comparison.h"
#include "exporters/formats/metrics_report.h"

namespace velamap {

// Keys of sigmas and significance exist if the sigmas are known. Adds the tables parts and lines
// and, for the files only, reference_from_shape and markers.
void AddMetrics(const ShapeDeviation& deviation, MetricsReport* report);

// Adds surface_note and table surfaces with part and surface_distance_mm.
void AddMetrics(const SurfaceComparison& comparison, MetricsReport* report);

// Adds section_frame, num_significant_section_numbers, section_note and table section_differences.
void AddMetrics(const SectionComparison& comparison, MetricsReport* report);

// Sets figures that are smaller than rounding errors can be, below 1e-9 of their unit (m, mm, deg,
// percent), to zero.
void DropRoundingErrors(MetricsReport* report);

}  // namespace velamap
