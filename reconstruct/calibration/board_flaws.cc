#include "reconstruct/calibration/board_flaws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/base/statistics.h"
#include "importer/geometry/principal_axes.h"

namespace velamap {
namespace {

constexpr double kFlat = 0.02;  // RMS distance from the plane, of the extent

// The corners 1..4 of each whole marker.
std::map<int, std::array<Eigen::Vector3d, kNumCorners>> WholeMarkers(const Model& model) {
  std::map<int, std::array<Eigen::Vector3d, kNumCorners>> markers;
  std::map<int, std::size_t> num_corners;
  for (const auto& [point3D_id, point] : model.points3D) {
    const CornerId corner = CornerFromPoint3DId(point3D_id);
    markers[corner.marker_id][static_cast<std::size_t>(corner.corner) - 1] = point.x_in_world;
    ++num_corners[corner.marker_id];
  }
  for (const auto& [marker_id, count] : num_corners) {
    if (count < kNumCorners) markers.erase(marker_id);
  }
  return markers;
}

void MeasureBend(const Model& model, const PointCovariance& points, BoardFlaws* flaws) {
  const double count = static_cast<double>(model.points3D.size());
  std::vector<Eigen::Vector3d> points_m;
  for (const auto& [point3D_id, point] : model.points3D) points_m.push_back(point.x_in_world);
  for (const Eigen::Vector3d& a : points_m) {
    for (const Eigen::Vector3d& b : points_m) {
      flaws->extent_m = std::max(flaws->extent_m, (a - b).norm());
    }
  }
  const PrincipalAxes axes = ComputePrincipalAxes(points_m);
  const Eigen::Vector3d normal = axes.directions.col(0);
  double variance_m2 = 0.0;
  for (const auto& [point3D_id, point] : model.points3D) {
    flaws->max_bend_m =
        std::max(flaws->max_bend_m, std::abs(normal.dot(point.x_in_world - axes.mean)));
    variance_m2 += normal.dot(PointCovarianceOf(points, point3D_id) * normal) / count;
  }
  flaws->bend_m = std::sqrt(std::max(0.0, axes.sums_of_squares[0]) / count);
  flaws->bend_sigma_m = std::sqrt(variance_m2);
  flaws->is_flat = flaws->bend_m < kFlat * flaws->extent_m;
}

}  // namespace

BoardFlaws FindBoardFlaws(const Model& model, const PointCovariance& points) {
  BoardFlaws flaws;
  MeasureBend(model, points, &flaws);
  if (!flaws.is_flat) return flaws;
  std::vector<double> sides_m;
  double stretch_sum = 0.0;
  PointGradient gradient;
  const auto markers = WholeMarkers(model);
  for (const auto& [marker_id, x] : markers) {
    const double width_m = 0.5 * ((x[1] - x[0]).norm() + (x[2] - x[3]).norm());
    const double height_m = 0.5 * ((x[3] - x[0]).norm() + (x[2] - x[1]).norm());
    stretch_sum += std::log(width_m / height_m);
    sides_m.push_back(0.5 * (width_m + height_m));
    // Adds the derivative of log(width / height) with respect to one end of a side; the other end
    // has the opposite.
    const auto add = [&gradient, id = marker_id, corners = x](std::size_t from, std::size_t to,
                                                              double by_length) {
      const Eigen::Vector3d by_end = 0.5 * by_length * (corners[to] - corners[from]).normalized();
      gradient.emplace_back(Point3DIdFromCorner({id, static_cast<int>(to) + 1}), by_end);
      gradient.emplace_back(Point3DIdFromCorner({id, static_cast<int>(from) + 1}), -by_end);
    };
    add(0, 1, 1.0 / width_m);
    add(3, 2, 1.0 / width_m);
    add(0, 3, -1.0 / height_m);
    add(1, 2, -1.0 / height_m);
  }
  if (markers.empty()) return flaws;
  const double count = static_cast<double>(markers.size());
  flaws.stretch = stretch_sum / count;
  flaws.stretch_sigma = std::sqrt(VarianceOf(points, gradient)) / count;
  const Statistics sides = ComputeStatistics(sides_m);
  if (sides.count > 2) flaws.size_scatter = sides.standard_deviation / sides.mean;
  return flaws;
}

}  // namespace velamap
