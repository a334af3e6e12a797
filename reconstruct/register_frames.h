// Registration: from detections to poses of frames and positions of markers.

#pragma once

#include <map>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// Registers the images by the method in the options. Throws as documented in
// reconstruct/global/global_registration.h and reconstruct/thesis/thesis_registration.h. The order
// of `images` and their ids do not change the result.
Registration RegisterFrames(const std::vector<DatabaseImage>& images,
                            const std::map<CameraId, Camera>& cameras, const Layout& layout,
                            const RegistrationOptions& options);

}  // namespace velamap
