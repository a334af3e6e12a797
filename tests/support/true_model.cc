#include "tests/support/true_model.h"

#include <utility>

namespace velamap {

Model TrueModel(const SyntheticScene& scene, double unit_m) {
  Model model;
  model.cameras[1] = scene.camera;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    ModelImage image;
    image.image_id = static_cast<ImageId>(i + 1);
    image.camera_id = 1;
    image.name = scene.frames[i].image_name;
    image.cam_from_world = scene.cam_from_world[i];
    image.cam_from_world.translation /= unit_m;
    for (const MarkerDetection& marker : scene.frames[i].markers) {
      for (int corner = 1; corner <= kNumCorners; ++corner) {
        const Point3DId id = Point3DIdFromCorner({marker.marker_id, corner});
        Point3D& point = model.points3D[id];
        point.x_in_world = scene.x_in_world.at(marker.marker_id)[corner] / unit_m;
        point.track.push_back({image.image_id, static_cast<std::uint32_t>(image.points2D.size())});
        image.points2D.push_back({marker.corners_in_image_px[corner - 1], id});
      }
    }
    model.images.push_back(std::move(image));
  }
  return model;
}

MarkerShape TrueShape(const SyntheticScene& scene) {
  MarkerShape shape;
  for (const auto& [marker_id, points] : scene.x_in_world) {
    ShapeMarker marker;
    marker.marker_id = marker_id;
    for (std::size_t i = 0; i < points.size(); ++i) marker.x_in_shape_m[i] = points[i];
    shape.markers.push_back(marker);
  }
  return shape;
}

}  // namespace velamap
