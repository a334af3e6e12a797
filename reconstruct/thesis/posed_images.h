// What all registrations of one database by the thesis's method have in common, whatever their
// central frame: its images in order, every marker posed alone (thesis 3.3). That is a large part
// of the work of one.

#pragma once

#include <map>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

// By frame_idx: images with markers by frame number or name. Points into the images and cameras
// that it was made of.
struct PosedImages {
  std::vector<const DatabaseImage*> images;
  std::vector<FrameShape> frames;
  std::vector<const Camera*> cameras;
};

PosedImages PoseImages(const std::vector<DatabaseImage>& images,
                       const std::map<CameraId, Camera>& cameras, const Layout& layout);

}  // namespace velamap
