// The order of the images in a registration, and the central image that the user names.

#pragma once

#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// Images with markers, sorted by frame number, then name, so that the order of rows and ids in the
// database do not change the result.
std::vector<const DatabaseImage*> CanonicalOrder(const std::vector<DatabaseImage>& images);

// Tells whether the images are a video. Throws InputError if the option demands a video but frame
// numbers are missing.
bool UseTimeOrder(const std::vector<const DatabaseImage*>& images, FrameOrder order);

// Index of the image that options.central_frame names. Throws InputError if there is no such image
// or it has too few markers.
int FindCentralFrame(const std::vector<const DatabaseImage*>& images,
                     const RegistrationOptions& options);

}  // namespace velamap
