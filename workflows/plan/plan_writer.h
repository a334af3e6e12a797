// A plan as text and as CSV.

#pragma once

#include <iosfwd>
#include <string>

#include "workflows/plan/shoot_plan.h"

namespace velamap {

// One sentence: where to film from, how far around, with what shutter; of a better path where the
// planned one is bad, and "none" where there is no such path.
std::string RecommendationText(const ShootPlan& plan);

// Verdict and recommendation, then `key: value` lines, then the tables.
void PrintPlan(const ShootPlan& plan, std::ostream& out);

// Columns: table, distance_m, angle_deg, arc_deg, num_views, speed_m_s, in_picture, found, side_px,
// longest_exposure_s, marker_sigma_mm, distance_sigma_mm, distance_after_scaling_sigma_mm,
// scale_sigma_percent. `table` is view, shutter, or what a path changes. Unknown values are empty.
void WritePlanCsv(const ShootPlan& plan, std::ostream& out);

// Columns: marker_id, part, x_m, y_m, z_m (plan frame), num_views (expected), side_px, sigma_mm.
// The sigma is empty for a marker that the simulated views do not reconstruct.
void WriteMarkersCsv(const ShootPlan& plan, std::ostream& out);

}  // namespace velamap
