// Treats portrait and landscape pictures of one camera, whose pixels were turned, as pictures of a
// single camera during an adjustment.

#pragma once

#include <map>

#include "reconstruct/model/model.h"

namespace velamap {

// A camera that is another one turned clockwise.
struct TurnedCamera {
  CameraId upright_id = 0;
  int quarter_turns = 0;  // 1 or 3
};

struct TurnedCameras {
  std::map<CameraId, TurnedCamera> cameras;
  std::map<ImageId, CameraId> camera_of_image;  // of the images that were turned back
  bool Any() const { return !cameras.empty(); }
};

// Turns the images of every camera that is another camera of the model turned by 90 or 270 degrees
// (its parameters to nine digits; by 90 where both fit) back to that one, with their poses, and
// removes the turned camera. The camera of the first image stays.
TurnedCameras TieTurnedCameras(Model* model);

// Turns the same images the other way: quarter_turns becomes 3 instead of 1, or 1 instead of 3.
// Only the principal point shows which of the two is right.
void TurnTheOtherWay(TurnedCameras* turned, Model* model);

// The inverse, after an adjustment of the model: turned cameras follow the ones they were tied to.
void UntieTurnedCameras(const TurnedCameras& turned, Model* model);

}  // namespace velamap
