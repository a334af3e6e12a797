// The sigmas of corners, from the database to the adjustment.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/model/model.h"

namespace velamap {

// What the detector knows about the errors of the corners, px.
struct CornerSigmas {
  // 1 sigma of a corner's coordinate, by point2D_idx. 0 or a missing image: unknown.
  std::map<ImageId, std::vector<double>> of_image;
  double common_inset_px = 0.0;  // FormationEstimate::inset_sigma_px
};

// `formation` comes from the database; nothing where that has none.
CornerSigmas CornerSigmasOf(const std::vector<DatabaseImage>& images,
                            const std::optional<FormationEstimate>& formation = std::nullopt);

}  // namespace velamap
