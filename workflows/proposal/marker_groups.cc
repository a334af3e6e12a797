#include "workflows/proposal/marker_groups.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "importer/geometry/principal_axes.h"

namespace velamap {
namespace {

// The plane of a group whose markers lie in one; a sail is more curved than this.
std::optional<FacePlane> PlaneOf(const ClipMap& map, const MarkerGroup& group) {
  constexpr double kMaxRms = 0.01;  // of the smaller extent in the plane
  constexpr std::size_t kMinMarkers = 3;
  const std::vector<int> ids = group.rows.MarkerIds();
  if (ids.size() < kMinMarkers) return std::nullopt;
  std::vector<Eigen::Vector3d> corners;
  for (const int marker_id : ids) {
    const MarkerPoints& points = map.bodies[group.body_idx].at(marker_id);
    corners.insert(corners.end(), points.begin() + 1, points.end());
  }
  const PrincipalAxes axes = ComputePrincipalAxes(corners);
  const Eigen::Vector3d rms_m =
      (axes.sums_of_squares.cwiseMax(0.0) / static_cast<double>(corners.size())).cwiseSqrt();
  if (rms_m[0] > kMaxRms * rms_m[1]) return std::nullopt;
  return FacePlane{axes.directions.col(0), rms_m[0]};
}

}  // namespace

std::vector<MarkerGroup> FindMarkerGroups(const ClipMap& map) {
  std::vector<MarkerGroup> groups;
  for (std::size_t i = 0; i < map.bodies.size(); ++i) {
    for (RowGroup& rows : FindMarkerRows(map.bodies[i])) groups.push_back({std::move(rows), i});
  }
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return a.rows.MarkerIds().size() > b.rows.MarkerIds().size();
  });
  return groups;
}

std::map<std::size_t, FacePlane> FindFaces(const ClipMap& map,
                                           const std::vector<MarkerGroup>& groups) {
  constexpr double kMaxCosine = 0.94;  // 20 degrees
  std::map<std::size_t, FacePlane> planes, faces;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (const auto plane = PlaneOf(map, groups[i])) planes.emplace(i, *plane);
  }
  for (const auto& [i, plane] : planes) {
    for (const auto& [k, other] : planes) {
      if (groups[k].body_idx == groups[i].body_idx &&
          std::abs(plane.normal.dot(other.normal)) < kMaxCosine) {
        faces.emplace(i, plane);
      }
    }
  }
  return faces;
}

}  // namespace velamap
