#include "exporters/shape/common_corners.h"

#include <algorithm>

namespace velamap {

CommonCorners FindCommonCorners(const MarkerShape& shape, const MarkerShape& reference,
                                const std::vector<int>& marker_ids) {
  CommonCorners corners;
  for (const ShapeMarker& marker : shape.markers) {
    const bool is_selected = marker_ids.empty() || std::find(marker_ids.begin(), marker_ids.end(),
                                                             marker.marker_id) != marker_ids.end();
    const ShapeMarker* other = FindMarker(reference, marker.marker_id);
    if (!is_selected || other == nullptr) continue;
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const auto idx = static_cast<std::size_t>(corner);
      if (!marker.x_in_shape_m[idx] || !other->x_in_shape_m[idx]) continue;
      corners.ids.push_back({marker.marker_id, corner});
      corners.x_in_shape_m.push_back(*marker.x_in_shape_m[idx]);
      corners.x_in_reference_m.push_back(*other->x_in_shape_m[idx]);
    }
  }
  return corners;
}

}  // namespace velamap
