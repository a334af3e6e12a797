// Errors of corners according to the database.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/registration/corner_motions.h"

namespace velamap {

struct CornerErrors {
  // 1 sigma of a corner's coordinate, by point2D_idx, px. 0 or a missing image: unknown.
  std::map<ImageId, std::vector<double>> sigmas_px;
  // Determine how far a rolling shutter displaces the corners.
  CornerMotions motions;
  // 1 sigma of the distance by which all corners are seen too far inside their markers, px:
  // FormationEstimate::inset_sigma_px, or 0.01 where nothing was estimated.
  double common_inset_px = 0.0;
};

// `formation` comes from the database; nothing if that has none.
CornerErrors CornerErrorsOf(const std::vector<DatabaseImage>& images,
                            const std::optional<FormationEstimate>& formation = std::nullopt);

}  // namespace velamap
