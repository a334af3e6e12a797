// Registration by the thesis's method (sections 3.4 and 3.5): frames are aligned with a central
// frame, and the places of their markers are averaged.
//
// A video is searched in time order. Photographs have no time order: there the central frame is the
// one that has most markers in common with the others, and images are added one after another to
// the growing mean shape, so that those that share nothing with the central frame are reached
// through others.

#pragma once

#include "importer/layout/layout.h"
#include "reconstruct/registration/registration.h"
#include "reconstruct/registration/registration_options.h"
#include "reconstruct/thesis/posed_images.h"

namespace velamap {

// Registers images whose markers are posed already, so that several central frames of one clip
// share that work. The shape is in metres by the nominal marker sides. Throws DataError with the
// reason when fewer than two images hold markers, or none can be registered with the central one;
// InputError for an unknown central frame. The order of the images and their ids do not matter.
Registration RegisterAroundCentralFrame(const PosedImages& posed, const Layout& layout,
                                        const RegistrationOptions& options);

}  // namespace velamap
