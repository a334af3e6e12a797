// Finds the camera of images that come without a calibration.
//
// 1. Starts. The focal length is estimated from the squares of single markers, for a rectilinear
//    lens and for a fisheye (camera/focal_evidence.h). Other starts are the focal length in the
//    database (from EXIF, or a guess) and, if the estimate is uncertain, longer and shorter ones.
// 2. Each start is registered and adjusted with all cameras free. The adjustment also chooses the
//    camera model (adjust/camera_adjustment.h). Both are repeated with the better camera until it
//    no longer changes.
// 3. The start that explains most corners wins. A start that explains nearly all ends the search.
//
// Corners do not depend on the camera, so nothing has to be imported again.

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
// database. Always registers by the global method, regardless of `registration`, and at most 40
// frames of a video. Throws DataError if no start leads to a model.
std::map<CameraId, Camera> FindCameras(const std::vector<DatabaseImage>& images,
                                       const std::map<CameraId, Camera>& guesses,
                                       const Layout& layout, const CornerErrors& corner_errors,
                                       const RegistrationOptions& registration,
                                       const MarkerAdjustmentOptions& adjustment);

}  // namespace velamap
