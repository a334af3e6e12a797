// The table marker_sources that velamap adds to COLMAP's: the file that each photograph was read
// from, or the video. README.md of this folder describes its columns.
//
// Errors of SQLite arrive as SQLite::Exception; ColmapDatabase turns them into input errors.

#pragma once

#include <map>
#include <string>

#include "importer/video/source_file.h"

namespace SQLite {
class Database;
}

namespace velamap {

// The name of a video's row; the video is the source of all its frames.
inline constexpr char kVideoSource[] = "";

// Creates the table if it is missing, or brings it up to date. Replaces the row of that name.
void WriteSourceRow(const std::string& image_name, const SourceFile& source,
                    SQLite::Database* database);

// By image name; empty in the database of an earlier velamap.
std::map<std::string, SourceFile> ReadSourceRows(SQLite::Database* database);

}  // namespace velamap
