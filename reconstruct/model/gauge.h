// Orders a model for COLMAP's bundle adjuster.
//
// COLMAP 3.8 fixes the gauge by the pose of the first image and the x coordinate of the second
// image's translation. With images in time order this coordinate can be nearly zero; the scale then
// drifts by orders of magnitude. OrderForGauge therefore places the world frame at the first
// image's camera and moves the image with the largest |t_x| to the second place. A similarity of
// the input changes nothing but the model's scale.

#pragma once

#include "reconstruct/model/model.h"

namespace velamap {

// The camera of `first_image_id` becomes the world frame. Images from the third on are sorted by
// id.
void OrderForGauge(ImageId first_image_id, Model* model);

// The camera of the first image becomes the world frame, exactly.
void MoveToFirstCamera(Model* model);

// Transforms the model into another world frame: x_in_new = new_from_world * x_in_world.
void TransformModel(const Sim3& new_from_world, Model* model);

}  // namespace velamap
