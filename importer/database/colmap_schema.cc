#include "importer/database/colmap_schema.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "importer/base/atomic_output.h"
#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/database/marker_detections_table.h"

namespace velamap {
namespace {

constexpr std::array<const char*, 6> kColmapTables = {
    "cameras", "images", "keypoints", "descriptors", "matches", "two_view_geometries"};

constexpr char kColmapSchema[] = R"(
CREATE TABLE cameras (
    camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
    model INTEGER NOT NULL,
    width INTEGER NOT NULL,
    height INTEGER NOT NULL,
    params BLOB,
    prior_focal_length INTEGER NOT NULL);
CREATE TABLE images (
    image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
    name TEXT NOT NULL UNIQUE,
    camera_id INTEGER NOT NULL,
    prior_qw REAL,
    prior_qx REAL,
    prior_qy REAL,
    prior_qz REAL,
    prior_tx REAL,
    prior_ty REAL,
    prior_tz REAL,
    CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647),
    FOREIGN KEY(camera_id) REFERENCES cameras(camera_id));
CREATE UNIQUE INDEX index_name ON images(name);
CREATE TABLE keypoints (
    image_id INTEGER PRIMARY KEY NOT NULL,
    rows INTEGER NOT NULL,
    cols INTEGER NOT NULL,
    data BLOB,
    FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE descriptors (
    image_id INTEGER PRIMARY KEY NOT NULL,
    rows INTEGER NOT NULL,
    cols INTEGER NOT NULL,
    data BLOB,
    FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);
CREATE TABLE matches (
    pair_id INTEGER PRIMARY KEY NOT NULL,
    rows INTEGER NOT NULL,
    cols INTEGER NOT NULL,
    data BLOB);
CREATE TABLE two_view_geometries (
    pair_id INTEGER PRIMARY KEY NOT NULL,
    rows INTEGER NOT NULL,
    cols INTEGER NOT NULL,
    data BLOB,
    config INTEGER NOT NULL,
    F BLOB,
    E BLOB,
    H BLOB,
    qvec BLOB,
    tvec BLOB);
PRAGMA user_version = 3800;
)";

}  // namespace

std::set<std::string> ColumnNames(const SQLite::Database& database, const std::string& table) {
  std::set<std::string> names;
  SQLite::Statement query(database, "SELECT name FROM pragma_table_info(?)");
  query.bind(1, table);
  while (query.executeStep()) names.insert(query.getColumn(0).getString());
  return names;
}

void CheckDatabaseFile(const std::string& path, bool writing) {
  const bool exists = Exists(path);
  if (!exists && !writing) {
    throw InputError(
        fmt::format("{}: there is no such database; make it with velamap marker_importer", path));
  }
  if (!exists) {
    const std::filesystem::path folder = CanonicalPath(path).parent_path();
    if (!IsFolder(folder)) {
      throw InputError(
          fmt::format("{}: cannot be created: there is no folder {}", path, folder.string()));
    }
    return;
  }
  if (!IsRegularFile(path)) throw InputError(path + ": not a regular file");
  constexpr char kMagic[] = "SQLite format 3";
  char begin[sizeof(kMagic)] = {};
  std::ifstream stream(path, std::ios::binary);
  stream.read(begin, sizeof(begin));
  const bool empty = stream.gcount() == 0 && stream.eof();
  if (!empty && std::memcmp(begin, kMagic, sizeof(kMagic)) != 0) {
    throw InputError(fmt::format("{}: not an SQLite database; choose another file", path));
  }
}

void CheckColmapTables(const std::string& path, const SQLite::Database& database) {
  for (const char* table : kColmapTables) {
    if (!database.tableExists(table)) {
      throw InputError(
          fmt::format("{}: the database of another program (no table '{}' of COLMAP); "
                      "choose another file",
                      path, table));
    }
  }
}

bool IsFresh(const SQLite::Database& database) {
  SQLite::Statement query(database, "SELECT COUNT(*) FROM sqlite_master");
  query.executeStep();
  return query.getColumn(0).getInt64() == 0;
}

void CreateTables(SQLite::Database* database) {
  database->exec(kColmapSchema);
  CreateMarkerDetectionsTable(database);
}

void CheckCanBeAddedTo(const std::string& path, SQLite::Database* database) {
  CheckColmapTables(path, *database);
  if (ColumnNames(*database, "images").count("prior_qw") == 0) {
    throw InputError(
        fmt::format("{}: made by COLMAP 3.10 or later, whose schema the other "
                    "versions refuse; choose a new file (velamap writes the schema that "
                    "COLMAP 3.5 to 4.x open)",
                    path));
  }
  if (database->tableExists("frames") &&
      database->execAndGet("SELECT COUNT(*) FROM frames").getInt64() > 0) {
    throw InputError(fmt::format(
        "{}: holds frames of COLMAP 3.12 or later, which velamap does not write; choose a new file",
        path));
  }
  SQLite::Statement images(*database, "SELECT name FROM images ORDER BY name LIMIT 1");
  if (!ReadDetectorOfDetections(database) && images.executeStep()) {
    throw InputError(
        fmt::format("{}: holds images that velamap has not imported, such as {}; delete it, or "
                    "write to a new place",
                    path, images.getColumn(0).getString()));
  }
}

void CheckUnfinishedCanBeAddedTo(const std::string& path) {
  constexpr std::array<const char*, 2> kSuffixes = {"-journal", "-wal"};
  const auto is_there = [&](const char* suffix) {
    return IsRegularFile(path + suffix) && FileSize(path + suffix) > 0;
  };
  if (std::none_of(kSuffixes.begin(), kSuffixes.end(), is_there)) return;
  const TemporaryFolder folder;
  const std::string copy_path = folder.path() / "database.db";
  CopyFile(path, copy_path);
  for (const char* suffix : kSuffixes) {
    if (is_there(suffix)) CopyFile(path + suffix, copy_path + suffix);
  }
  try {
    SQLite::Database copy(copy_path, SQLite::OPEN_READWRITE);
    if (!IsFresh(copy)) CheckCanBeAddedTo(path, &copy);
  } catch (const SQLite::Exception&) {
    // Another program may have written while the files were copied; it then holds a lock, which
    // the database itself will report.
  }
}

}  // namespace velamap
