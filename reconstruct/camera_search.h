// Finds the camera of images that come without a calibration.
//
// 1. Start: the focal length that the markers' own squares speak for (camera/focal_evidence.h), for
// a
//    lens that keeps lines straight and for a fisheye; the focal length that the database has (from
//    EXIF, else a guess); and others within the evidence's sigma where it is vague.
// 2. From each start: registration, then an adjustment with all cameras free and the camera model
//    chosen by the evidence (adjust/camera_adjustment.h), and again with the better camera until it
//    stays.
// 3. The start that explains most wins. A start that explains nearly all corners ends the search.
//
// Corners do not depend on the camera, so that nothing is imported again.

#pragma once

#include <map>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/problem/corner_errors.h"
#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// The cameras by id, those of turned pictures as turned cameras. `guesses` are the cameras of the
// database. Registers by the global method whatever `registration` says, and at most 40 frames of a
// video. Throws DataError where no start leads to a model.
std::map<CameraId, Camera> FindCameras(const std::vector<DatabaseImage>& images,
                                       const std::map<CameraId, Camera>& guesses,
                                       const Layout& layout, const CornerErrors& corner_errors,
                                       const RegistrationOptions& registration,
                                       const MarkerAdjustmentOptions& adjustment);

}  // namespace velamap
