// Portrait and landscape pictures of one camera, whose pixels were turned, as one camera.

#pragma once

#include <map>
#include <set>

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

// The same images turned the other way, 1 for 3 and 3 for 1: which way it was shows only in the
// principal point.
void TurnTheOtherWay(TurnedCameras* turned, Model* model);

// The inverse, after an adjustment of the model: turned cameras follow the ones they were tied to.
void UntieTurnedCameras(const TurnedCameras& turned, Model* model);

}  // namespace velamap
