// Global registration: a map of all markers grown from several starts, without a central frame.
//
// Frames are selected by their gain in precision and registered by robust resection on all known
// corners; every marker is placed by the consensus of all frames that see it, and both planar
// solutions are kept until the views decide. The whole map is adjusted (map_adjustment.h)
// repeatedly while it grows, and the map that explains the corners best is kept. The steps are
// listed in reconstruct/README.md.

#pragma once

#include <map>
#include <vector>

#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// RegisterFrames() with RegistrationMethod::kGlobal, and the same contract. Also throws DataError
// when no consistent map is found. Adds a note to a result whose errors are larger than the noise
// of the corners explains.
Registration RegisterFramesGlobally(const std::vector<DatabaseImage>& images,
                                    const std::map<CameraId, Camera>& cameras, const Layout& layout,
                                    const RegistrationOptions& options);

}  // namespace velamap
