// Global registration: a map of all markers grown from several starts, without a central frame.
//
// Frames are chosen for what they add, registered by robust resection on all known corners, and
// every marker is placed by the consensus of all frames that see it; both planar solutions stay
// until views decide. Everything is adjusted together (reconstruct/global/map_adjustment.h) again
// and again while the map grows, and the map that explains most corners best is kept. Steps in
// reconstruct/README.md.

#pragma once

#include <map>
#include <vector>

#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// RegisterFrames() with RegistrationMethod::kGlobal; the same contract. Throws DataError too when
// nothing consistent is found. A result whose errors are larger than the noise of the corners
// explains is returned with a note that says so.
Registration RegisterFramesGlobally(const std::vector<DatabaseImage>& images,
                                    const std::map<CameraId, Camera>& cameras, const Layout& layout,
                                    const RegistrationOptions& options);

}  // namespace velamap
