#include "tests/workflows/commands/true_model.h"

namespace velamap {

Model TrueModel(const SyntheticScene& scene) {
  constexpr double kUnitInM = 2.0;
  Model model;
  model.cameras[1] = scene.camera;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    ModelImage image;
    image.image_id = static_cast<ImageId>(i + 1);
    image.camera_id = 1;
    image.name = scene.frames[i].image_name;
    image.cam_from_world = scene.cam_from_world[i];
    image.cam_from_world.translation /= kUnitInM;
    for (const MarkerDetection& marker : scene.frames[i].markers) {
      for (int corner = 1; corner <= kNumCorners; ++corner) {
        const std::size_t idx = static_cast<std::size_t>(corner);
        const Point3DId id = Point3DIdFromCorner({marker.marker_id, corner});
        Point3D& point = model.points3D[id];
        point.x_in_world = scene.x_in_world.at(marker.marker_id)[idx] / kUnitInM;
        point.track.push_back({image.image_id, static_cast<std::uint32_t>(image.points2D.size())});
        image.points2D.push_back({marker.corners_in_image_px[idx - 1], id});
      }
    }
    model.images.push_back(image);
  }
  return model;
}

}  // namespace velamap
