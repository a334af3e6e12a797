// Views of a marker on a surface that moves while it is filmed. They look like outliers, but are
// right: without them, a marker comes to be where it stays longest, instead of at its mean place.

#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"
#include "reconstruct/model/model.h"

namespace velamap {

// A marker in one image of a video.
struct TrackedView {
  std::array<Eigen::Vector2d, kNumCorners> errors_px;  // of the corners from their places
  double side_px = 0.0;
  bool is_outlier = false;
};

// Tells for each view of one marker, in the order of time, whether it is an outlier because the
// surface moved: the marker is displaced as a whole, by less than its side, and most of the
// displacement is also that of the view before, of the one after, or of their mean. What covers a
// marker displaces single corners, and a wrong id is farther away. Of a marker with few such views
// none counts, because their loss does no harm.
std::vector<bool> FindMovedViews(const std::vector<TrackedView>& views);

// The place of each image in the natural order of their names, which in a video is that of time.
std::map<ImageId, std::size_t> OrderInTime(const Model& model);

}  // namespace velamap
