#include "workflows/plan/plan_precision.h"

#include <random>

#include <fmt/format.h>

#include "exporters/scale/metric_shape.h"
#include "exporters/shape/shape_metrics.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "reconstruct/adjust/marker_adjustment.h"

namespace velamap {
namespace {

constexpr CameraId kCameraId = 1;

// The true model and its observations.
class Clip {
 public:
  Clip(const PlannedSurface& surface, const Camera& camera, const ShootPlanOptions& options)
      : surface_(surface), options_(options), random_(options.seed) {
    model.cameras[kCameraId] = camera;
  }

  void Add(const Rigid3& cam_from_plan) {
    ModelImage image;
    image.image_id = static_cast<ImageId>(model.images.size() + 1);
    image.camera_id = kCameraId;
    image.name = fmt::format("view_{:06d}", image.image_id);
    image.cam_from_world = cam_from_plan;
    for (const MarkerView& view :
         SeeMarkers(surface_, model.cameras.at(kCameraId), cam_from_plan)) {
      if (unit_(random_) < view.found_share) Observe(view, &image);
    }
    model.images.push_back(std::move(image));
  }

  Model model;
  CornerErrors corner_errors;

 private:
  void Observe(const MarkerView& view, ModelImage* image) {
    const double sigma_px = ExpectedCornerSigma(options_.corner_sigma_px, view.side_px);
    const ShapeMarker& marker = *FindMarker(surface_.shape, view.marker_id);
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      const Point3DId id = Point3DIdFromCorner({view.marker_id, corner});
      const auto corner_idx = static_cast<std::size_t>(corner);
      Point3D& point = model.points3D[id];
      point.x_in_world = *marker.x_in_shape_m[corner_idx];
      point.track.push_back({image->image_id, static_cast<std::uint32_t>(image->points2D.size())});
      const double right = normal_(random_), down = normal_(random_);
      image->points2D.push_back(
          {view.corners_in_image_px[corner_idx - 1] + sigma_px * Eigen::Vector2d(right, down), id});
      corner_errors.sigmas_px[image->image_id].push_back(sigma_px);
    }
  }

  const PlannedSurface& surface_;
  const ShootPlanOptions& options_;
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_;
  std::normal_distribution<double> normal_;
};

}  // namespace

PlanPrecision SimulatePlan(const PlannedSurface& surface, const Camera& camera,
                           const PlannedPath& path, const ShootPlanOptions& options) {
  Clip clip(surface, camera, options);
  for (const double angle_deg : AnglesOf(path)) clip.Add(CameraAt(surface, path, angle_deg));
  RemoveShortTracks(&clip.model, 2);
  if (clip.model.points3D.empty()) throw DataError("no marker is seen in two views");
  MarkerAdjustmentOptions adjustment;
  adjustment.num_threads = options.num_threads;
  const MarkerAdjustmentSummary summary =
      AdjustWithMarkers(adjustment, surface.layout, clip.corner_errors, &clip.model);
  const PointCovariance& points = summary.uncertainty.points;
  PlanPrecision precision;
  precision.marker_sigma_mm = CenterSigmas_mm(points);
  if (precision.marker_sigma_mm.empty()) throw DataError("no marker is left with all four corners");
  precision.scale_sigma = summary.uncertainty.relative_scale_sigma;
  const ReferenceMetrics comparison = ComputeReferenceMetrics(
      ShapeFromModel(clip.model, surface.layout, &points), surface.shape, &points);
  precision.distance_sigma_mm = kMmPerM * comparison.distance_sigma_m.value();
  precision.distance_after_scaling_sigma_mm =
      kMmPerM * comparison.distance_after_scaling_sigma_m.value();
  precision.warnings = summary.warnings;
  return precision;
}

}  // namespace velamap
