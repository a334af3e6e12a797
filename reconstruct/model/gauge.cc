#include "reconstruct/model/gauge.h"

#include <algorithm>
#include <cmath>

#include "importer/base/error.h"

namespace velamap {

void OrderForGauge(ImageId first_image_id, Model* model) {
  std::vector<ModelImage>& images = model->images;
  std::sort(images.begin(), images.end(),
            [](const ModelImage& a, const ModelImage& b) { return a.image_id < b.image_id; });
  const auto first = std::find_if(
      images.begin(), images.end(),
      [first_image_id](const ModelImage& image) { return image.image_id == first_image_id; });
  VELAMAP_CHECK(first != images.end());
  std::rotate(images.begin(), first, std::next(first));

  MoveToFirstCamera(model);
  const auto second = std::max_element(std::next(images.begin()), images.end(),
                                       [](const ModelImage& a, const ModelImage& b) {
                                         return std::abs(a.cam_from_world.translation.x()) <
                                                std::abs(b.cam_from_world.translation.x());
                                       });
  if (second != images.end()) std::rotate(std::next(images.begin()), second, std::next(second));
}

void MoveToFirstCamera(Model* model) {
  const Rigid3 first_from_world = model->images.front().cam_from_world;
  TransformModel({1.0, first_from_world.rotation, first_from_world.translation}, model);
  model->images.front().cam_from_world = Rigid3{};  // without rounding
}

void TransformModel(const Sim3& new_from_world, Model* model) {
  const Eigen::Quaterniond world_from_new_rotation = new_from_world.rotation.conjugate();
  for (auto& [point3D_id, point] : model->points3D) {
    point.x_in_world = new_from_world * point.x_in_world;
  }
  for (ModelImage& image : model->images) {
    // Cam frames are scaled as well: x_in_cam becomes scale * x_in_cam.
    Rigid3& pose = image.cam_from_world;
    pose.rotation = (pose.rotation * world_from_new_rotation).normalized();
    pose.translation =
        new_from_world.scale * pose.translation - pose.rotation * new_from_world.translation;
  }
}

}  // namespace velamap
