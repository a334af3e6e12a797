// The table marker_part that velamap adds to COLMAP's: which part of a video the database holds.
// README.md of this folder describes its columns.
//
// Errors of SQLite arrive as SQLite::Exception; ColmapDatabase turns them into input errors.

#pragma once

#include <optional>
#include <string>

#include "importer/video/video_options.h"

namespace SQLite {
class Database;
}

namespace velamap {

// One of the parts into which the import of a video is split (importer/import_part.h).
struct VideoPart {
  int number = 1;  // from 1 to `count`
  int count = 1;
};

inline constexpr int kMaxNumParts = 100;

// "2/5", as the option --video_part takes it.
std::string PartText(const VideoPart& part);

// What the import of a part notes, so that only parts of one import are merged.
struct PartRecord {
  VideoPart part;
  VideoOptions whole;        // the frames of all parts
  std::string detector;      // DescribeDetector(); a part without markers has no other trace of it
  bool is_finished = false;  // whether all frames of the part have been searched
};

// Creates the table if it is missing and replaces its row.
void WritePart(const PartRecord& record, SQLite::Database* database);

// Returns nothing for the database of a whole import. Throws InputError, naming the path, for
// values that no import writes.
std::optional<PartRecord> ReadPart(const std::string& path, SQLite::Database* database);

}  // namespace velamap
