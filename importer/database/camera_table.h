// COLMAP's table cameras.
//
// Errors of SQLite arrive as SQLite::Exception; ColmapDatabase turns them into input errors.

#pragma once

#include <map>
#include <string>

#include "importer/base/ids.h"
#include "importer/camera/camera.h"

namespace SQLite {
class Database;
}

namespace velamap {

// Returns the new camera's id.
CameraId InsertCamera(const Camera& camera, bool is_calibrated, SQLite::Database* database);

// Whether no camera has prior_focal_length 0. Cameras that have images, but none with marker
// detections, do not count: another program added them.
bool AllCamerasAreCalibrated(SQLite::Database* database);

// Skips cameras with a model that velamap does not support; velamap did not import those. Throws
// InputError for a wrong number of parameters, and for an image size or a focal length that is not
// positive.
std::map<CameraId, Camera> ReadCameraRows(const std::string& path, SQLite::Database* database);

}  // namespace velamap
