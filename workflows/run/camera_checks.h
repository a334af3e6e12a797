// The cameras of a reconstruction: estimated where there is no calibration, checked where there is
// one. Each function logs what it finds.

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/model/model.h"
#include "reconstruct/register_frames.h"

namespace velamap {

// Ends an error about images whose cameras are not known.
constexpr const char* kOrWithCalibration = "; or import the images with the camera's calibration";

// FindCameras() of reconstruct/camera_search.h. `guesses` are the cameras of a database without a
// calibration; a focal length that EXIF claims is compared with what the images show. The corners
// of `images` are moved to where the fit would have found them with these cameras
// (CorrectForLensBend()). Throws DataError if the images do not determine the cameras.
std::map<CameraId, Camera> FindUnknownCameras(const std::map<CameraId, Camera>& guesses,
                                              const Layout& layout,
                                              const CornerErrors& corner_errors,
                                              const RegistrationOptions& registration,
                                              const MarkerAdjustmentOptions& adjustment,
                                              std::vector<DatabaseImage>* images);

// Warns where the images contradict a calibration that has no fisheye model and fit such a model
// better. `seed` and `adjusted` are the model before and after its marker-aware adjustment.
void WarnOfFisheye(const MarkerAdjustmentOptions& options, const Layout& layout,
                   const CornerErrors& corner_errors, const Model& seed, const Model& adjusted,
                   const std::optional<AdjustmentUncertainty>& uncertainty);

// Warns where the images were not taken by one steady camera; throws DataError where that camera
// was to be found (`options.find_camera`) and its focal length changes. `seed` is the model before
// its marker-aware adjustment, null without one. The verdict holds a step of the focal length only
// if it is real.
SteadinessVerdict CheckSteadiness(const MarkerAdjustmentOptions& options, const Layout& layout,
                                  const CornerErrors& corner_errors, const Model* seed,
                                  const Model& model);

}  // namespace velamap
