#include "exporters/scale/metric_shape.h"

#include <set>

#include "exporters/shape/shape_sigma.h"
#include "reconstruct/model/gauge.h"

namespace velamap {
namespace {

int CountImages(const Point3D& point) {
  std::set<ImageId> image_ids;
  for (const TrackElement& element : point.track) image_ids.insert(element.image_id);
  return static_cast<int>(image_ids.size());
}

}  // namespace

void ScaleModel(const ScaleEstimate& scale, Model* model) {
  Sim3 shape_from_world;
  shape_from_world.scale = scale.m_per_unit;
  TransformModel(shape_from_world, model);
}

MarkerShape ShapeFromModel(const Model& metric_model, const Layout& layout,
                           const PointCovariance* covariance) {
  MarkerShape shape;
  // Ids are sorted by marker, then corner.
  for (const auto& [point3D_id, point] : metric_model.points3D) {
    if (!IsCornerPoint3DId(point3D_id)) continue;
    const CornerId id = CornerFromPoint3DId(point3D_id);
    if (shape.markers.empty() || shape.markers.back().marker_id != id.marker_id) {
      shape.markers.emplace_back();
      shape.markers.back().marker_id = id.marker_id;
      shape.markers.back().part = PartOfMarker(layout, id.marker_id);
    }
    ShapeMarker& marker = shape.markers.back();
    marker.x_in_shape_m[id.corner] = point.x_in_world;
    marker.num_frames[id.corner] = CountImages(point);
  }
  for (ShapeMarker& marker : shape.markers) {
    SetCenter(&marker);
    for (int corner = 0; corner <= kNumCorners; ++corner) {
      if (!marker.x_in_shape_m[corner]) continue;
      marker.sigma_m[corner] = PointSigma(covariance, marker.marker_id, corner);
    }
  }
  return shape;
}

bool IsShapeOf(const MarkerShape& shape, const Model& metric_model) {
  constexpr double kTolerance_m = 1e-6;
  for (const ShapeMarker& marker : shape.markers) {
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      if (!marker.x_in_shape_m[corner]) continue;
      const auto point =
          metric_model.points3D.find(Point3DIdFromCorner({marker.marker_id, corner}));
      if (point == metric_model.points3D.end()) return false;
      const Eigen::Vector3d difference = point->second.x_in_world - *marker.x_in_shape_m[corner];
      if (!(difference.norm() <= kTolerance_m)) return false;
    }
  }
  return true;
}

}  // namespace velamap
