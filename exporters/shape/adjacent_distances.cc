#include "exporters/shape/adjacent_distances.h"

#include "exporters/shape/shape_sigma.h"

namespace velamap {

std::vector<AdjacentDistance> CompareAdjacentDistances(const MarkerShape& shape,
                                                       const MarkerShape& reference,
                                                       const Layout& layout,
                                                       const PointCovariance* covariance) {
  const auto distance_m = [](const ShapeMarker& marker1, const ShapeMarker& marker2) {
    return (*marker1.x_in_shape_m[0] - *marker2.x_in_shape_m[0]).norm();
  };
  const auto is_known = [&](int id) {
    return FindWholeMarker(shape, id) != nullptr && FindWholeMarker(reference, id) != nullptr;
  };
  std::vector<AdjacentDistance> distances;
  for (const auto& [id1, neighbors] : BuildAdjacencyGraph(layout)) {
    for (const int id2 : neighbors) {
      if (id1 > id2 || !is_known(id1) || !is_known(id2)) continue;
      const ShapeMarker& marker1 = *FindWholeMarker(shape, id1);
      const ShapeMarker& marker2 = *FindWholeMarker(shape, id2);
      distances.push_back(
          {id1, id2, distance_m(marker1, marker2),
           distance_m(*FindWholeMarker(reference, id1), *FindWholeMarker(reference, id2)),
           SigmaOf(covariance, DistanceGradient(marker1, 0, marker2, 0))});
    }
  }
  return distances;
}

}  // namespace velamap
