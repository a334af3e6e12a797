#include "exporters/compare/shape_likeness.h"

#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "exporters/shape/common_corners.h"
#include "importer/base/statistics.h"
#include "importer/geometry/alignment.h"

namespace velamap {
namespace {

constexpr std::size_t kMinMarkers = 3;
constexpr double kMaxScaleDifference = 0.05;

// Root mean square distance from the mean.
double SizeOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : points) mean += x / static_cast<double>(points.size());
  std::vector<double> distances_m;
  for (const Eigen::Vector3d& x : points) distances_m.push_back((x - mean).norm());
  return Rms(distances_m);
}

std::optional<ShapeLikeness> LikenessOf(const CommonCorners& corners) {
  const double size_m = SizeOf(corners.x_in_reference_m);
  if (!(size_m > 0) || !(SizeOf(corners.x_in_shape_m) > 0)) return std::nullopt;
  const Sim3 reference_from_shape = EstimateSim3(corners.x_in_shape_m, corners.x_in_reference_m);
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < corners.ids.size(); ++i) {
    distances_m.push_back(
        (reference_from_shape * corners.x_in_shape_m[i] - corners.x_in_reference_m[i]).norm());
  }
  ShapeLikeness likeness;
  likeness.scale = 1.0 / reference_from_shape.scale;
  likeness.distance_m = Rms(distances_m);
  likeness.misfit = likeness.distance_m / size_m;
  return likeness;
}

}  // namespace

std::optional<ShapeLikeness> MeasureLikeness(const MarkerShape& shape, const MarkerShape& reference,
                                             const Layout& layout) {
  std::map<std::string, std::vector<int>> parts;
  std::vector<int> all;
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole() || FindWholeMarker(reference, marker.marker_id) == nullptr) continue;
    const std::string part =
        layout.HasMarkers() ? PartOfMarker(layout, marker.marker_id) : marker.part;
    parts[part].push_back(marker.marker_id);
    all.push_back(marker.marker_id);
  }
  std::optional<ShapeLikeness> best;
  const auto take = [&](const std::vector<int>& marker_ids) {
    if (marker_ids.size() < kMinMarkers) return;
    const auto likeness = LikenessOf(FindCommonCorners(shape, reference, marker_ids));
    if (likeness && (!best || likeness->misfit < best->misfit)) best = likeness;
  };
  for (const auto& [part, marker_ids] : parts) take(marker_ids);
  if (!best) take(all);
  return best;
}

std::optional<ComparisonDoubt> DoubtOf(const ShapeLikeness& likeness) {
  if (likeness.IsOfAnotherObject()) {
    return ComparisonDoubt{
        true, fmt::format("the two shapes are not of the same object: even turned and scaled to "
                          "fit, their common markers are {:.2g} m apart (RMS), {:.0f} % of the "
                          "size of the reference; check both paths, and that the markers of both "
                          "are those of one layout",
                          likeness.distance_m, 100 * likeness.misfit)};
  }
  if (std::abs(likeness.scale - 1) > kMaxScaleDifference) {
    return ComparisonDoubt{
        false, fmt::format("the shape is {:.4g} times as large as the reference, and no alignment "
                           "changes this; check marker_length in the layouts of both",
                           likeness.scale)};
  }
  return std::nullopt;
}

std::optional<ComparisonDoubt> DoubtOfSurfaceFit(const MarkerShape& shape, double distance_m,
                                                 int num_over_surface, int num_markers) {
  constexpr double kMinShareOver = 0.25;
  std::vector<Eigen::Vector3d> corners_m;  // centres would give a single marker no size
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole()) continue;
    for (int i = 1; i <= kNumCorners; ++i) corners_m.push_back(*marker.x_in_shape_m[i]);
  }
  const double misfit = distance_m / SizeOf(corners_m);
  if (misfit > kMaxMisfit) {
    return ComparisonDoubt{
        true, fmt::format("the reference is not a surface of this object: in the best fit, the "
                          "markers are {:.2g} m from it (RMS), {:.0f} % of the size of the shape; "
                          "check the file and its unit",
                          distance_m, 100 * misfit)};
  }
  if (num_over_surface < kMinShareOver * num_markers) {
    return ComparisonDoubt{
        false, fmt::format("{} of {} markers lie over the surface of the reference; check that it "
                           "is the surface of this object, and its unit, or name its --part",
                           num_over_surface, num_markers)};
  }
  return std::nullopt;
}

bool IsThousandfold(double ratio) {
  constexpr double kTolerance = 0.07;
  return std::abs(ratio / 1000.0 - 1) <= kTolerance;
}

}  // namespace velamap
