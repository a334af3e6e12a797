// Compares the corners found in a rendered clip with the truth from its files.

#pragma once

#include <filesystem>
#include <vector>

#include "importer/database/colmap_database.h"

namespace velamap {

struct CornerComparison {
  int frame_number = 0, marker_id = 0;
  bool is_fallback = false;
  double side_px = 0.0;           // true mean length of the sides
  double side_error_px = 0.0;     // found minus true mean length of the sides
  double corner_error_px = 0.0;   // RMS over the four corners
  double error_over_sigma = 0.0;  // RMS over the coordinates of error / sigma; 0 without sigmas
  // Whether the centre is more than a side away from the truth: a misread marker or a chance match.
  bool is_false = false;
};

// Compares the detections in the video of a clip with the truth in the clip's folder (camera.yml,
// truth.csv, poses.csv). The surfaces of the clip must not move. Throws InputError if the files do
// not match the images.
std::vector<CornerComparison> CompareCorners(const std::filesystem::path& clip_folder,
                                             const std::vector<DatabaseImage>& images);

}  // namespace velamap
