#include "reconstruct/register_frames.h"

#include "reconstruct/global/global_registration.h"
#include "reconstruct/thesis/posed_images.h"
#include "reconstruct/thesis/thesis_registration.h"

namespace velamap {

Registration RegisterFrames(const std::vector<DatabaseImage>& images,
                            const std::map<CameraId, Camera>& cameras, const Layout& layout,
                            const RegistrationOptions& options) {
  options.Check();
  if (options.method == RegistrationMethod::kGlobal) {
    return RegisterFramesGlobally(images, cameras, layout, options);
  }
  return RegisterAroundCentralFrame(PoseImages(images, cameras, layout, options.num_threads),
                                    layout, options);
}

}  // namespace velamap
