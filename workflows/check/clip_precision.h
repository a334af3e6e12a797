// The precision that a few frames of a clip would give: a reconstruction of them alone.

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"
#include "workflows/check/clip_facts.h"

namespace velamap {

// The largest angle between two of the directions, rad; 0 for fewer than two.
double LargestAngle(const std::vector<Eigen::Vector3d>& directions);

// Registers and adjusts the images of a database, and finds the cameras before if it has no
// calibration. Throws DataError if the images give no shape or no cameras.
ClipPrecision MeasurePrecision(const std::string& database_path, const Layout& layout,
                               int num_threads);

}  // namespace velamap
