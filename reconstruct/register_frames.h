// The door of the registration: detections in, poses of frames and places of markers out.

#pragma once

#include <map>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// Registers the images by the method that the options name:
// reconstruct/global/global_registration.h or reconstruct/thesis/thesis_registration.h, which say
// what is thrown. The order of `images` and their ids do not matter.
Registration RegisterFrames(const std::vector<DatabaseImage>& images,
                            const std::map<CameraId, Camera>& cameras, const Layout& layout,
                            const RegistrationOptions& options);

}  // namespace velamap
