// The tables that velamap adds to COLMAP's: marker_detections, and marker_detector with the one row
// that says how the detections were made. README.md of this folder describes their columns.
//
// Errors of SQLite arrive as SQLite::Exception; ColmapDatabase turns them into input errors.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/base/ids.h"
#include "importer/database/colmap_database.h"
#include "importer/detect/detection.h"

namespace SQLite {
class Database;
}

namespace velamap {

// Creates the tables if they are missing, and brings those of an earlier velamap up to date.
void CreateMarkerDetectionsTable(SQLite::Database* database);

// Inserts one row for each detection, or one with a NULL marker_id for an image without any.
// `detector` must be the same for all images of a database.
void InsertMarkerDetections(ImageId image_id, const FrameDetections& detections,
                            const std::string& detector, SQLite::Database* database);

// Returns all images with rows in the table, by image_id. Columns that an earlier velamap did not
// write are read as unknown. Throws InputError, naming the path, for values of a wrong size, a
// marker id out of range, a corner that is not finite, and an image name that leads out of its
// folder.
std::vector<DatabaseImage> ReadImagesWithDetections(const std::string& path,
                                                    SQLite::Database* database);

// Returns how the detections were made, or nothing if there are none.
std::optional<std::string> ReadDetectorOfDetections(SQLite::Database* database);

}  // namespace velamap
