// marker_detections: the table that velamap adds to COLMAP's. The README says what it holds.
//
// Errors of SQLite come as SQLite::Exception, as ColmapDatabase, the only user, expects them.

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

// Creates the table, or adds the columns that one of an earlier velamap lacks.
void CreateMarkerDetectionsTable(SQLite::Database* database);

// One row for each detection, or one with a NULL marker_id for an image without any.
void InsertMarkerDetections(ImageId image_id, const FrameDetections& detections,
                            const std::string& detector, SQLite::Database* database);

void DeleteMarkerDetections(ImageId image_id, SQLite::Database* database);

// All images with rows in the table, by image_id. Columns that an earlier velamap did not write are
// read as unknown. Throws InputError, naming the path, for a row that cannot be.
std::vector<DatabaseImage> ReadImagesWithDetections(const std::string& path,
                                                    SQLite::Database* database);

// What the rows say on how they were made; nothing without a table or rows.
std::optional<std::string> ReadDetectorOfDetections(SQLite::Database* database);

}  // namespace velamap
