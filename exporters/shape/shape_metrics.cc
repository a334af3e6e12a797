#include "exporters/shape/shape_metrics.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "exporters/shape/common_corners.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/error.h"
#include "importer/geometry/alignment.h"
#include "importer/geometry/units.h"
#include "reconstruct/geometry/covariance_update.h"

namespace velamap {
namespace {

constexpr int kMinCommonPoints = 3;

bool LieInOnePoint(const std::vector<Eigen::Vector3d>& points) {
  return std::all_of(points.begin(), points.end(),
                     [&](const Eigen::Vector3d& x) { return x == points.front(); });
}

template <typename Transform>
std::vector<double> Distances(const Transform& reference_from_shape,
                              const std::vector<Eigen::Vector3d>& x_in_shape_m,
                              const std::vector<Eigen::Vector3d>& x_in_reference_m) {
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < x_in_shape_m.size(); ++i) {
    distances_m.push_back((reference_from_shape * x_in_shape_m[i] - x_in_reference_m[i]).norm());
  }
  return distances_m;
}

// Means of the distances by marker. `ids` are the ids of the points, sorted by marker.
std::vector<MarkerDistance> DistancesOfMarkers(const std::vector<CornerId>& ids,
                                               const std::vector<double>& distances_m,
                                               const std::vector<double>& after_scaling_m) {
  std::vector<MarkerDistance> markers;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (markers.empty() || markers.back().marker_id != ids[i].marker_id) {
      markers.push_back({ids[i].marker_id, 0, 0.0, 0.0});
    }
    ++markers.back().num_corners;
    markers.back().distance_m += distances_m[i];
    markers.back().distance_after_scaling_m += after_scaling_m[i];
  }
  for (MarkerDistance& marker : markers) {
    marker.distance_m /= marker.num_corners;
    marker.distance_after_scaling_m /= marker.num_corners;
  }
  return markers;
}

// Mean of variances; unknown if one of them is.
class VarianceMean {
 public:
  void Add(const std::optional<double>& sigma) {
    is_known_ = is_known_ && sigma.has_value();
    sum_ += sigma.value_or(0.0) * sigma.value_or(0.0);
    ++count_;
  }
  std::optional<double> RootOfMean() const {
    if (!is_known_ || count_ == 0) return std::nullopt;
    return std::sqrt(sum_ / count_);
  }

 private:
  bool is_known_ = true;
  double sum_ = 0.0;
  int count_ = 0;
};

std::optional<double> Times(double factor, std::optional<double> value) {
  if (value) *value *= factor;
  return value;
}

MarkerMetrics MetricsOfMarker(const ShapeMarker& marker, double printed_side_m,
                              const PointCovariance* covariance,
                              std::vector<double>* side_errors_mm) {
  const double printed_area_m2 = printed_side_m * printed_side_m;
  const double area_error_m2 = std::abs(MarkerArea(marker) - printed_area_m2);
  MarkerMetrics metrics;
  metrics.marker_id = marker.marker_id;
  metrics.part = marker.part;
  metrics.area_error_mm2 = area_error_m2 * kMmPerM * kMmPerM;
  metrics.area_error_percent = 100.0 * area_error_m2 / printed_area_m2;
  metrics.area_sigma_mm2 = Times(kMmPerM * kMmPerM, SigmaOf(covariance, AreaGradient(marker)));
  metrics.mean_side_sigma_mm = Times(kMmPerM, SigmaOf(covariance, MeanSideGradient(marker)));
  const auto sides_m = MarkerSides(marker);
  metrics.mean_side_mm = kMmPerM * MeanSide(sides_m);
  for (const double side_m : sides_m) {
    side_errors_mm->push_back(std::abs(side_m - printed_side_m) * kMmPerM);
    metrics.side_error_mm += side_errors_mm->back() / kNumCorners;
  }
  return metrics;
}

// Predicts the distances of the points `ids` at `x_in_shape_m` from their true places after an
// alignment.
void PredictDistances(const PointCovariance* covariance, const std::vector<CornerId>& ids,
                      const std::vector<Eigen::Vector3d>& x_in_shape_m,
                      ReferenceMetrics* comparison) {
  if (covariance == nullptr) return;
  std::vector<Point3DId> point3D_ids;
  for (const CornerId& id : ids) point3D_ids.push_back(Point3DIdFromCorner(id));
  PointCovariance points = Subset(*covariance, point3D_ids);
  if (points.point3D_ids != point3D_ids) return;
  ToInnerConstraints(x_in_shape_m, &points);
  // A change of scale is orthogonal to all rigid motions of the points.
  const Eigen::VectorXd by_scale = ScaleGradient(x_in_shape_m).normalized();
  const double of_scale = by_scale.dot(Multiply(points, by_scale).col(0));
  const double trace = Trace(points), count = static_cast<double>(ids.size());
  comparison->distance_sigma_m = std::sqrt(std::max(0.0, trace) / count);
  comparison->distance_after_scaling_sigma_m = std::sqrt(std::max(0.0, trace - of_scale) / count);
}

void CheckHasMarkersOf(const Layout& layout, const MarkerShape& shape) {
  if (!layout.HasMarkers() || shape.markers.empty()) return;
  const std::vector<int> ids = MarkerIds(layout);
  const bool has_one =
      std::any_of(shape.markers.begin(), shape.markers.end(), [&](const ShapeMarker& marker) {
        return std::binary_search(ids.begin(), ids.end(), marker.marker_id);
      });
  if (has_one) return;
  throw DataError(fmt::format(
      "none of the {} markers of the shape, such as marker {}, is in the layout; give the layout "
      "of this surface",
      shape.markers.size(), shape.markers.front().marker_id));
}

bool HasLines(const Layout& layout, const std::string& part_name) {
  return std::any_of(layout.parts.begin(), layout.parts.end(), [&](const LayoutPart& part) {
    return part.name == part_name && !(part.horizontal.empty() && part.vertical.empty());
  });
}

void CountMarkers(const Layout& layout, const MarkerShape& shape, ShapeMetrics* metrics) {
  if (!layout.HasMarkers()) return;
  const std::vector<int> layout_ids = MarkerIds(layout);
  for (const MarkerMetrics& marker : metrics->markers) {
    if (!std::binary_search(layout_ids.begin(), layout_ids.end(), marker.marker_id)) {
      metrics->other_marker_ids.push_back(marker.marker_id);
    }
  }
  int num_sail = 0, num_sail_whole = 0;
  for (const int marker_id : layout_ids) {
    const bool whole = FindWholeMarker(shape, marker_id) != nullptr;
    if (!whole) metrics->missing_marker_ids.push_back(marker_id);
    if (!HasLines(layout, PartOfMarker(layout, marker_id))) continue;
    ++num_sail;
    num_sail_whole += whole;
  }
  const int num_markers = static_cast<int>(layout_ids.size());
  const int num_missing = static_cast<int>(metrics->missing_marker_ids.size());
  metrics->num_layout_markers = num_markers;
  metrics->reconstruction_ratio = static_cast<double>(num_markers - num_missing) / num_markers;
  if (num_sail == 0) return;
  metrics->num_sail_markers = num_sail;
  metrics->sail_reconstruction_ratio = static_cast<double>(num_sail_whole) / num_sail;
}

}  // namespace

ShapeMetrics ComputeShapeMetrics(const MarkerShape& shape, const Layout& layout,
                                 const PointCovariance* covariance) {
  CheckHasMarkersOf(layout, shape);
  ShapeMetrics metrics;
  std::vector<double> area_errors_mm2, area_errors_percent, side_errors_mm;
  VarianceMean area_variance, side_variance;
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole()) continue;
    ++metrics.num_markers;
    metrics.markers.push_back(MetricsOfMarker(marker, MarkerLength(layout, marker.marker_id),
                                              covariance, &side_errors_mm));
    area_variance.Add(metrics.markers.back().area_sigma_mm2);
    for (int side = 1; side <= kNumCorners; ++side) {
      side_variance.Add(SigmaOf(covariance, SideGradient(marker, side)));
    }
    area_errors_mm2.push_back(metrics.markers.back().area_error_mm2);
    area_errors_percent.push_back(metrics.markers.back().area_error_percent);
  }
  metrics.area_error_mm2 = ComputeStatistics(std::move(area_errors_mm2));
  metrics.area_error_percent = ComputeStatistics(std::move(area_errors_percent));
  metrics.side_error_mm = ComputeStatistics(std::move(side_errors_mm));
  metrics.area_sigma_mm2 = area_variance.RootOfMean();
  metrics.side_sigma_mm = Times(kMmPerM, side_variance.RootOfMean());

  CountMarkers(layout, shape, &metrics);
  return metrics;
}

ReferenceMetrics ComputeReferenceMetrics(const MarkerShape& shape, const MarkerShape& reference,
                                         const PointCovariance* covariance) {
  const auto [ids, x_in_shape_m, x_in_reference_m] = FindCommonCorners(shape, reference);
  VarianceMean point_variance;
  for (const CornerId& id : ids) {
    const auto& sigma_m = FindMarker(shape, id.marker_id)->sigma_m[id.corner];
    point_variance.Add(sigma_m ? std::optional(sigma_m->norm()) : std::nullopt);
  }
  ReferenceMetrics comparison;
  comparison.num_points = static_cast<int>(x_in_shape_m.size());
  if (comparison.num_points < kMinCommonPoints) {
    throw DataError("the shape and its reference have " + std::to_string(comparison.num_points) +
                    " marker corners in common; an alignment needs " +
                    std::to_string(kMinCommonPoints));
  }
  if (LieInOnePoint(x_in_shape_m) || LieInOnePoint(x_in_reference_m)) {
    throw DataError("the corners that the shape and its reference share lie in one point");
  }
  // Distances are in the frame and the metres of the reference.
  const std::vector<double> distances_m =
      Distances(EstimateRigid3(x_in_shape_m, x_in_reference_m), x_in_shape_m, x_in_reference_m);
  const Sim3 reference_from_shape = EstimateSim3(x_in_shape_m, x_in_reference_m);
  const std::vector<double> after_scaling_m =
      Distances(reference_from_shape, x_in_shape_m, x_in_reference_m);
  comparison.distance_m = ComputeStatistics(distances_m);
  comparison.distance_sigma_m = point_variance.RootOfMean();
  PredictDistances(covariance, ids, x_in_shape_m, &comparison);
  comparison.scale = 1.0 / reference_from_shape.scale;
  comparison.distance_after_scaling_m = ComputeStatistics(after_scaling_m);
  comparison.markers = DistancesOfMarkers(ids, distances_m, after_scaling_m);
  return comparison;
}

}  // namespace velamap
