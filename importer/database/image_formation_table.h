// The table image_formation that velamap adds to COLMAP's: its one row holds the image formation
// (how camera and print displace edges). README.md of this folder describes its columns.
//
// Errors of SQLite arrive as SQLite::Exception; ColmapDatabase turns them into input errors.

#pragma once

#include <optional>
#include <string>

#include "importer/pattern/formation_estimate.h"

namespace SQLite {
class Database;
}

namespace velamap {

// Creates the table if it is missing and replaces its row.
void WriteImageFormation(const FormationEstimate& estimate, SQLite::Database* database);

// Returns nothing for the database of an earlier velamap or of an import without an estimate.
// Throws InputError, naming the path, for a value that is not a number or that no estimate gives.
std::optional<FormationEstimate> ReadImageFormation(const std::string& path,
                                                    SQLite::Database* database);

}  // namespace velamap
