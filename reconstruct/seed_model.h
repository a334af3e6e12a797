// From a registration to the COLMAP model that the bundle adjustment starts from.

#pragma once

#include <iosfwd>
#include <map>
#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/model/model.h"
#include "reconstruct/registration/registration.h"

namespace velamap {

// Contains every registered image with all keypoints of the database, and every corner of the mean
// shape as point 10*k + c with its complete track and the mean colour over the track. The central
// image comes first and is the origin; reconstruct/model/gauge.h defines the order of the others.
// Images with fewer than two markers are left out, and so are points with fewer than two
// observations unless the registration has a single frame. Throws DataError if no point or fewer
// than two images are left (no image, for a registration of a single frame).
Model MakeSeedModel(const Registration& registration, const std::vector<DatabaseImage>& images,
                    const std::map<CameraId, Camera>& cameras);

// One row per image with markers: image_name, registered, num_markers, num_outliers, rms_error_mm,
// reason, outliers (marker ids, each with its reason where the method gives one).
void WriteRegistrationCsv(const Registration& registration, std::ostream& out);

}  // namespace velamap
