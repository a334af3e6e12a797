#include "reconstruct/thesis/posed_images.h"

#include "reconstruct/registration/frame_order.h"

namespace velamap {

PosedImages PoseImages(const std::vector<DatabaseImage>& images,
                       const std::map<CameraId, Camera>& cameras, const Layout& layout) {
  PosedImages posed;
  posed.images = CanonicalOrder(images);
  for (const DatabaseImage* image : posed.images) {
    const Camera& camera = cameras.at(image->camera_id);
    posed.frames.push_back(EstimateFrameShape(*image, camera, layout));
    posed.cameras.push_back(&camera);
  }
  return posed;
}

}  // namespace velamap
