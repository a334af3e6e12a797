// Reports on the known points. exporters/formats/README.md lists the keys.

#pragma once

#include <string>
#include <vector>

#include "exporters/datum/known_points.h"
#include "exporters/formats/metrics_report.h"

namespace velamap {

// Adds known_point_residual_mm, known_point_residual_in_sigmas, known_point_growth_percent and its
// sigma, check_point_error_mm, num_failed_check_points, known_points_note and the table
// known_points. Adds nothing for a layout without known points.
void AddMetrics(const KnownPointFit& fit, MetricsReport* report);

int CountPoints(const KnownPointFit& fit, PointState state);

// One line with the number of points used and their RMS distance, the number of passed checks, and
// the worst point; or why there is no frame.
std::string KnownPointsText(const KnownPointFit& fit);

// Warnings of each check that fails, of each point that contradicts the others, of a wrong size of
// the shape, and of points that give no frame.
std::vector<std::string> KnownPointWarnings(const KnownPointFit& fit);

}  // namespace velamap
