// Estimates the cameras of images that have no calibration.
//
// 1. Initial guesses. The focal length is estimated from the squares of single markers, once for a
//    rectilinear lens and once for a fisheye (camera/focal_evidence.h). Further guesses are the
//    camera in the database (from EXIF, or a default) and, if the estimate is uncertain, a longer
//    and a shorter focal length.
// 2. From each guess, the images are registered and adjusted with all cameras free. The adjustment
//    also selects the camera model (adjust/camera_adjustment.h). Both steps are repeated with the
//    new cameras until neither these nor the number of explained corners changes much, at most four
//    times.
// 3. The result that explains the most corners wins. The search stops early at a result that
//    explains 80 % of the corners.
//
// Marker detection does not depend on the camera, so the images need not be imported again.

#pragma once

#include <map>
#include <vector>

#include "importer/camera/camera.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/camera/focal_evidence.h"
#include "reconstruct/problem/corner_errors.h"
#include "reconstruct/problem/marker_adjustment_options.h"
#include "reconstruct/registration/registration_options.h"

namespace velamap {

// The squares of all markers of the images whose corners were fitted.
std::vector<SquareView> SquaresOf(const std::vector<DatabaseImage>& images,
                                  const MarkerAdjustmentOptions& adjustment);

// Returns the cameras by id; images that are stored rotated have a rotated camera of their own.
// `guesses` are the cameras of the database and are returned unchanged for fewer than two images.
// Always registers with the global method, even if `registration` names another one, and at most 40
// frames of a video.
// Throws DataError if no initial guess leads to a model.
std::map<CameraId, Camera> FindCameras(const std::vector<DatabaseImage>& images,
                                       const std::map<CameraId, Camera>& guesses,
                                       const Layout& layout, const CornerErrors& corner_errors,
                                       const RegistrationOptions& registration,
                                       const MarkerAdjustmentOptions& adjustment);

}  // namespace velamap
