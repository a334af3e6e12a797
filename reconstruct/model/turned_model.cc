#include "reconstruct/model/turned_model.h"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "importer/camera/turned_camera.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

bool IsSame(const Camera& a, const Camera& b) {
  constexpr double kSame = 1e-9;
  if (a.model != b.model || a.width_px != b.width_px || a.height_px != b.height_px) return false;
  for (std::size_t i = 0; i < a.params.size(); ++i) {
    if (std::abs(a.params[i] - b.params[i]) > kSame * (1.0 + std::abs(a.params[i]))) return false;
  }
  return true;
}

// 0 where `camera` is not `upright` turned.
int QuarterTurnsBetween(const Camera& upright, const Camera& camera) {
  if (!IsTransposedSize(upright, camera.width_px, camera.height_px)) return 0;
  for (const int quarter_turns : {1, 3}) {
    if (IsSame(TurnCamera(upright, quarter_turns), camera)) return quarter_turns;
  }
  return 0;
}

// Clockwise in the image is from x to y in the cam frame.
void TurnImage(const Camera& camera, int quarter_turns, ModelImage* image) {
  for (Point2D& point : image->points2D) {
    point.x_in_image_px = TurnInImage(camera, quarter_turns, point.x_in_image_px);
  }
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(quarter_turns * kPi / 2, Eigen::Vector3d::UnitZ()));
  image->cam_from_world.rotation = (turn * image->cam_from_world.rotation).normalized();
  image->cam_from_world.translation = turn * image->cam_from_world.translation;
}

}  // namespace

TurnedCameras TieTurnedCameras(Model* model) {
  TurnedCameras turned;
  if (model->images.empty()) return turned;
  std::vector<CameraId> upright_ids = {model->images.front().camera_id};
  for (const auto& [camera_id, camera] : model->cameras) {
    if (camera_id == upright_ids.front()) continue;
    for (const CameraId upright_id : upright_ids) {
      const int quarter_turns = QuarterTurnsBetween(model->cameras.at(upright_id), camera);
      if (quarter_turns == 0) continue;
      turned.cameras[camera_id] = {upright_id, quarter_turns};
      break;
    }
    if (turned.cameras.count(camera_id) == 0) upright_ids.push_back(camera_id);
  }
  for (ModelImage& image : model->images) {
    const auto entry = turned.cameras.find(image.camera_id);
    if (entry == turned.cameras.end()) continue;
    turned.camera_of_image[image.image_id] = image.camera_id;
    TurnImage(model->cameras.at(image.camera_id), -entry->second.quarter_turns, &image);
    image.camera_id = entry->second.upright_id;
  }
  for (const auto& [camera_id, of] : turned.cameras) model->cameras.erase(camera_id);
  return turned;
}

void TurnTheOtherWay(TurnedCameras* turned, Model* model) {
  for (auto& [camera_id, of] : turned->cameras) of.quarter_turns = 4 - of.quarter_turns;
  for (ModelImage& image : model->images) {
    if (turned->camera_of_image.count(image.image_id) == 0) continue;
    TurnImage(model->cameras.at(image.camera_id), 2, &image);
  }
}

void UntieTurnedCameras(const TurnedCameras& turned, Model* model) {
  for (const auto& [camera_id, of] : turned.cameras) {
    model->cameras[camera_id] = TurnCamera(model->cameras.at(of.upright_id), of.quarter_turns);
  }
  for (ModelImage& image : model->images) {
    const auto entry = turned.camera_of_image.find(image.image_id);
    if (entry == turned.camera_of_image.end()) continue;
    const TurnedCamera& of = turned.cameras.at(entry->second);
    TurnImage(model->cameras.at(image.camera_id), of.quarter_turns, &image);
    image.camera_id = entry->second;
  }
}

}  // namespace velamap
