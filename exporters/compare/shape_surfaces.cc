#include "exporters/compare/shape_surfaces.h"

#include <algorithm>
#include <iterator>
#include <set>

namespace velamap {

ShapeSurfaces::ShapeSurfaces(MarkerShape shape) : shape_(std::move(shape)) {}

const FittedSurface& ShapeSurfaces::Of(const LayoutPart& part) const { return Fit(part, shape_); }

const FittedSurface& ShapeSurfaces::OfCommon(const LayoutPart& part,
                                             const MarkerShape& other) const {
  MarkerShape common;
  std::copy_if(shape_.markers.begin(), shape_.markers.end(), std::back_inserter(common.markers),
               [&](const ShapeMarker& marker) {
                 return marker.IsWhole() && FindWholeMarker(other, marker.marker_id) != nullptr;
               });
  return Fit(part, common);
}

const FittedSurface& ShapeSurfaces::Fit(const LayoutPart& part, const MarkerShape& markers) const {
  const std::set<int> ids_of_part = MarkerIds(part);
  std::vector<int> ids;
  for (const ShapeMarker& marker : markers.markers) {
    if (marker.IsWhole() && ids_of_part.count(marker.marker_id) > 0) {
      ids.push_back(marker.marker_id);
    }
  }
  const auto key = std::make_pair(part.name, std::move(ids));
  const auto found = fits_.find(key);
  if (found != fits_.end()) return found->second;
  return fits_.emplace(key, FitSurface(CollectSurfaceInput(markers, part))).first->second;
}

}  // namespace velamap
