// Recognises and creates the tables of a COLMAP 3.8 database, and the one that velamap adds.

#pragma once

#include <string>

namespace SQLite {
class Database;
}

namespace velamap {

// Throws InputError, naming the path, for what SQLite would report less clearly or silently create:
// a missing file (unless writing), no folder for a new one, no regular file, no SQLite file.
void CheckDatabaseFile(const std::string& path, bool writing);

// Throws InputError if a table of COLMAP is missing.
void CheckColmapTables(const std::string& path, const SQLite::Database& database);

// Creates all tables in a fresh database and marker_detections in one of COLMAP, or adds what a
// marker_detections of an earlier velamap lacks. Throws InputError
// for a database of another program and for layouts that cannot be added to: COLMAP 3.10 or later.
void CreateMissingTables(const std::string& path, SQLite::Database* database);

}  // namespace velamap
