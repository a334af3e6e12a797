// The corners that were found in a rendered clip against those that its files say are true.

#pragma once

#include <filesystem>
#include <vector>

#include "importer/database/colmap_database.h"

namespace velamap {

struct CornerComparison {
  int frame_number = 0, marker_id = 0;
  bool is_fallback = false;
  double side_px = 0.0;           // true mean side
  double side_error_px = 0.0;     // of the mean side that was found
  double corner_error_px = 0.0;   // root mean square over the four corners
  double error_over_sigma = 0.0;  // the same of a coordinate's error over its sigma; 0 without
  // Found for another marker, or by chance: the centre is more than a side away from the truth.
  bool is_false = false;
};

// Compares the detections of a clip's video with the truth in the clip's folder (camera.yml,
// truth.csv, poses.csv), whose surfaces must not move. Throws InputError for files or a database
// that do not fit.
std::vector<CornerComparison> CompareCorners(const std::filesystem::path& clip_folder,
                                             const std::vector<DatabaseImage>& images);

}  // namespace velamap
