// The order in which images are looked at, and the one that the user names; for every method.

#pragma once

#include <string>
#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// Images with markers by frame number or name, so that neither row order nor ids decide anything.
std::vector<const DatabaseImage*> CanonicalOrder(const std::vector<DatabaseImage>& images);

// Whether the images are a video. InputError where the option says so and frame numbers are
// missing.
bool UseTimeOrder(const std::vector<const DatabaseImage*>& images, FrameOrder order);

// Index of the image that options.central_frame names; InputError where there is none, or where it
// holds fewer markers than are needed.
int FindCentralFrame(const std::vector<const DatabaseImage*>& images,
                     const RegistrationOptions& options);

}  // namespace velamap
