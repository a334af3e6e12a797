// Metrics as `key: value` lines, the form in which velamap prints results. Units stand in the keys;
// a statistic without values prints its count of 0 and no figures.

#pragma once

#include <iosfwd>

#include "exporters/shape_metrics.h"

namespace velamap {

// area_error_mm2_*, area_error_percent_*, side_error_mm_* with count, mean, std, median, min, max
// and rms; num_markers; and, where the layout names its markers, num_layout_markers,
// reconstruction_ratio and missing_marker_ids.
void PrintMetrics(const ShapeMetrics& metrics, std::ostream& out);

// num_points, distance_mm_*, scale, scale_error_percent, distance_after_scaling_mm_*.
void PrintMetrics(const ShapeComparison& comparison, std::ostream& out);

}  // namespace velamap
