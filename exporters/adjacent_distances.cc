#include "exporters/adjacent_distances.h"

#include <map>

namespace velamap {
namespace {

std::map<int, Eigen::Vector3d> CentersOf(const MarkerShape& shape) {
  std::map<int, Eigen::Vector3d> centers;
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.IsWhole()) centers[marker.marker_id] = *marker.x_in_shape_m[0];
  }
  return centers;
}

}  // namespace

std::vector<AdjacentDistance> CompareAdjacentDistances(const MarkerShape& shape,
                                                       const MarkerShape& reference,
                                                       const Layout& layout) {
  const auto centers = CentersOf(shape), reference_centers = CentersOf(reference);
  const auto is_known = [&](int id) {
    return centers.count(id) > 0 && reference_centers.count(id) > 0;
  };
  std::vector<AdjacentDistance> distances;
  for (const auto& [id1, neighbors] : BuildAdjacencyGraph(layout)) {
    for (const int id2 : neighbors) {
      if (id1 > id2 || !is_known(id1) || !is_known(id2)) continue;
      distances.push_back({id1, id2, (centers.at(id1) - centers.at(id2)).norm(),
                           (reference_centers.at(id1) - reference_centers.at(id2)).norm()});
    }
  }
  return distances;
}

}  // namespace velamap
