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

// Whether each camera is calibrated, except those whose images another program has added.
bool AllCamerasAreCalibrated(SQLite::Database* database);

// Leaves out cameras whose model velamap does not have, and therefore has not imported. Throws
// InputError for a wrong number of parameters, a picture without pixels or a focal length that is
// not positive.
std::map<CameraId, Camera> ReadCameraRows(const std::string& path, SQLite::Database* database);

}  // namespace velamap
