// The images of a database in order, with the pose of every single marker (thesis 3.3).
// Registrations by the thesis's method around different central frames share them, which saves a
// large part of the time of each.

#pragma once

#include <map>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

// All lists are by frame_idx: the images with markers in the order of frame numbers or names.
// Points into the images and cameras that it was made from.
struct PosedImages {
  std::vector<const DatabaseImage*> images;
  std::vector<FrameShape> frames;
  std::vector<const Camera*> cameras;
};

// Poses the markers on up to `num_threads` threads (0: one per core).
PosedImages PoseImages(const std::vector<DatabaseImage>& images,
                       const std::map<CameraId, Camera>& cameras, const Layout& layout,
                       int num_threads = 0);

}  // namespace velamap
