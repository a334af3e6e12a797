// Orders a model for COLMAP's bundle adjuster.
//
// COLMAP 3.8 fixes the gauge by the pose of the first image and the x of the second image's
// translation. In time order that x can be next to nothing, and the scale runs away. Here the
// world frame is placed at the first image's camera and the image with the largest |t_x| comes
// second. A similarity of the input changes nothing but the model's scale.

#pragma once

#include "reconstruct/model/model.h"

namespace velamap {

// `first_image_id` becomes the origin; the remaining images follow by image_id.
void OrderForGauge(ImageId first_image_id, Model* model);

// Moves the whole model into another world frame: x_in_new = new_from_world * x_in_world.
void TransformModel(const Sim3& new_from_world, Model* model);

}  // namespace velamap
