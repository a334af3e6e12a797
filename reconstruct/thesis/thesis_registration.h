// Registration by the thesis's method (sections 3.4 and 3.5): frames are aligned with a central
// frame, and the places of their markers are averaged.
//
// A video is searched in time order. Photographs have no such order: their central frame is the one
// that shares most markers with the others, and images are added one by one to the growing mean
// shape, which through other images reaches those that share nothing with the central frame.

#pragma once

#include "importer/layout/layout.h"
#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"
#include "reconstruct/thesis/posed_images.h"

namespace velamap {

// The shape is in metres by the nominal marker sides. The order of the images and their ids do not
// change the result. Throws DataError if fewer than two images contain markers or no image can be
// registered with the central one, and InputError for an unknown central frame.
Registration RegisterAroundCentralFrame(const PosedImages& posed, const Layout& layout,
                                        const RegistrationOptions& options);

}  // namespace velamap
