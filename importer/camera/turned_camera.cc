#include "importer/camera/turned_camera.h"

#include <utility>

#include "importer/camera/calibration.h"
#include "importer/camera/camera_projection.h"

namespace velamap {
namespace {

int NumQuarters(int quarter_turns) { return ((quarter_turns % 4) + 4) % 4; }

// Clockwise by 90 degrees: the ray (u, v) becomes (-v, u).
Camera TurnOnce(const Camera& camera) {
  Camera turned = camera;
  std::swap(turned.width_px, turned.height_px);
  const std::size_t center = NumFocalLengths(camera.model);
  if (center == 2) std::swap(turned.params[0], turned.params[1]);
  turned.params[center] = camera.height_px - camera.params[center + 1];
  turned.params[center + 1] = camera.params[center];
  if (camera.model == CameraModel::kOpenCV || camera.model == CameraModel::kFullOpenCV) {
    turned.params[6] = camera.params[7];
    turned.params[7] = -camera.params[6];
  }
  return turned;
}

}  // namespace

Camera TurnCamera(const Camera& camera, int quarter_turns) {
  Camera turned = camera;
  for (int i = 0; i < NumQuarters(quarter_turns); ++i) turned = TurnOnce(turned);
  return turned;
}

Eigen::Vector2d TurnInImage(const Camera& camera, int quarter_turns,
                            const Eigen::Vector2d& x_in_image_px) {
  Eigen::Vector2d turned = x_in_image_px;
  for (int i = 0; i < NumQuarters(quarter_turns); ++i) {
    const int height_px = i % 2 == 0 ? camera.height_px : camera.width_px;
    turned = Eigen::Vector2d(height_px - turned.y(), turned.x());
  }
  return turned;
}

bool IsTransposedSize(const Camera& camera, int width_px, int height_px) {
  if ((camera.width_px < camera.height_px) == (width_px < height_px)) return false;
  if (camera.width_px == camera.height_px || width_px == height_px) return false;
  return IsPureScale(camera, height_px, width_px);
}

}  // namespace velamap
