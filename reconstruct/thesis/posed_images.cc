#include "reconstruct/thesis/posed_images.h"

#include "importer/base/parallel.h"
#include "reconstruct/registration/frame_order.h"

namespace velamap {

PosedImages PoseImages(const std::vector<DatabaseImage>& images,
                       const std::map<CameraId, Camera>& cameras, const Layout& layout,
                       int num_threads) {
  PosedImages posed;
  posed.images = CanonicalOrder(images);
  for (const DatabaseImage* image : posed.images) {
    posed.cameras.push_back(&cameras.at(image->camera_id));
  }
  posed.frames.resize(posed.images.size());
  ParallelFor(posed.images.size(), num_threads, [&](std::size_t idx) {
    posed.frames[idx] = EstimateFrameShape(*posed.images[idx], *posed.cameras[idx], layout);
  });
  return posed;
}

}  // namespace velamap
