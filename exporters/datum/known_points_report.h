// Reports of the known points. exporters/formats/README.md lists the keys.

#pragma once

#include <string>
#include <vector>

#include "exporters/datum/known_points.h"
#include "exporters/formats/metrics_report.h"

namespace velamap {

// Adds known_point_residual_mm, known_point_residual_in_sigmas, known_point_growth_percent and its
// sigma, check_point_error_mm, num_failed_check_points, known_points_note and table known_points;
// nothing for a layout without known points.
void AddMetrics(const KnownPointFit& fit, MetricsReport* report);

int CountPoints(const KnownPointFit& fit, PointState state);

// One line: how many are used and how well they fit, the checks, the one that is farthest off.
std::string KnownPointsText(const KnownPointFit& fit);

// A warning for each check that fails, each point that contradicts the others, a size that the
// points contradict, and points that give no frame.
std::vector<std::string> KnownPointWarnings(const KnownPointFit& fit);

}  // namespace velamap
