// Databases that velamap does not open, or does not add to.

#include "importer/database/colmap_schema.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using Mode = ColmapDatabase::Mode;

TEST(ColmapSchema, NamesWhatIsWrongWithAFile) {
  const TempDir dir;
  const auto expect = [](const std::string& path, Mode mode, const std::string& part) {
    ExpectThrows<InputError>([&] { ColmapDatabase(path, mode); }, {path, part});
  };
  expect(dir / "none.db", Mode::kReadOnly, "no such database");
  EXPECT_FALSE(fs::exists(dir / "none.db"));
  expect(dir / "no/folder.db", Mode::kReadWriteCreate, "no folder");
  expect(dir.path(), Mode::kReadWriteCreate, "not a regular file");
  std::ofstream(dir / "text.db") << "some text that is no database, long enough";
  expect(dir / "text.db", Mode::kReadOnly, "not an SQLite database");
  expect(dir / "text.db", Mode::kReadWriteCreate, "not an SQLite database");
  std::ofstream(dir / "empty.db").close();
  expect(dir / "empty.db", Mode::kReadOnly, "another program");
  SQLite::Database(dir / "other.db", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE)
      .exec("CREATE TABLE music(title TEXT)");
  expect(dir / "other.db", Mode::kReadOnly, "another program");
  expect(dir / "other.db", Mode::kReadWriteCreate, "another program");
}

TEST(ColmapSchema, DoesNotAddToLayoutsOfLaterColmap) {
  const TempDir dir;
  const std::string later = dir / "later.db", frames = dir / "frames.db";
  { ColmapDatabase database(later, Mode::kReadWriteCreate); }
  fs::copy_file(later, frames);
  SQLite::Database(later, SQLite::OPEN_READWRITE).exec("ALTER TABLE images DROP COLUMN prior_qw");
  ExpectThrows<InputError>([&] { ColmapDatabase(later, Mode::kReadWriteCreate); },
                           {later, "COLMAP 3.10 or later", "choose a new file"});
  SQLite::Database(frames, SQLite::OPEN_READWRITE).exec("CREATE TABLE frames(frame_id INTEGER)");
  EXPECT_NO_THROW(ColmapDatabase(frames, Mode::kReadWriteCreate));
  SQLite::Database(frames, SQLite::OPEN_READWRITE).exec("INSERT INTO frames VALUES(1)");
  ExpectThrows<InputError>([&] { ColmapDatabase(frames, Mode::kReadWriteCreate); },
                           {frames, "COLMAP 3.12 or later"});
}

// Names and bytes of all files in the folder.
std::map<std::string, std::string> Contents(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    contents[entry.path().filename()] = std::string(std::istreambuf_iterator<char>(stream), {});
  }
  return contents;
}

// A database of COLMAP with an image that velamap has not imported.
void WriteForeignDatabase(const std::string& path) {
  { ColmapDatabase database(path, Mode::kReadWriteCreate); }
  SQLite::Database sqlite(path, SQLite::OPEN_READWRITE);
  sqlite.exec("DROP TABLE marker_detections");
  sqlite.exec("DROP TABLE marker_detector");
  sqlite.exec("INSERT INTO cameras VALUES(1, 1, 640, 480, NULL, 1)");
  sqlite.exec("INSERT INTO images(name, camera_id) VALUES('theirs.jpg', 1)");
}

void ExpectRefusedAndUnchanged(const TempDir& dir) {
  const std::string path = dir / "database.db";
  const auto before = Contents(dir.path());
  ExpectThrows<InputError>([&] { ColmapDatabase(path, Mode::kReadWriteCreate); },
                           {path, "has not imported, such as theirs.jpg", "write to a new place"});
  EXPECT_TRUE(Contents(dir.path()) == before);
}

TEST(ColmapSchema, ForeignDatabaseIsRefusedAndStaysAsItIs) {
  const TempDir dir;
  WriteForeignDatabase(dir / "database.db");
  ExpectRefusedAndUnchanged(dir);
  {
    SQLite::Database sqlite(dir / "database.db", SQLite::OPEN_READWRITE);
    EXPECT_EQ(sqlite.execAndGet("PRAGMA journal_mode=WAL").getString(), "wal");
  }
  ExpectRefusedAndUnchanged(dir);
}

TEST(ColmapSchema, ForeignDatabaseOfAnInterruptedProgramStaysAsItIs) {
  const TempDir work, log, journal;
  const std::string path = work / "database.db";
  // The image is in the write-ahead log only.
  { ColmapDatabase database(path, Mode::kReadWriteCreate); }
  {
    SQLite::Database sqlite(path, SQLite::OPEN_READWRITE);
    sqlite.exec("DROP TABLE marker_detections");
    sqlite.exec("DROP TABLE marker_detector");
    sqlite.execAndGet("PRAGMA journal_mode=WAL");
    sqlite.exec("INSERT INTO cameras VALUES(1, 1, 640, 480, NULL, 1)");
    sqlite.exec("INSERT INTO images(name, camera_id) VALUES('theirs.jpg', 1)");
    for (const std::string file : {"database.db", "database.db-wal"}) {
      fs::copy_file(work / file, log / file);
    }
  }
  ExpectRefusedAndUnchanged(log);
  {
    const ColmapDatabase database(log / "database.db", Mode::kReadOnly);
    EXPECT_EQ(database.ReadImageIdsByName().count("theirs.jpg"), 1u);
  }
  // The image was being deleted; the journal brings it back.
  {
    SQLite::Database sqlite(path, SQLite::OPEN_READWRITE);
    sqlite.execAndGet("PRAGMA journal_mode=DELETE");
    sqlite.exec("PRAGMA cache_size = 1");
    sqlite.exec("PRAGMA cache_spill = 1");
    sqlite.exec("BEGIN IMMEDIATE; DELETE FROM images; DELETE FROM cameras");
    sqlite.exec("CREATE TABLE filler(x)");
    sqlite.exec(
        "INSERT INTO filler WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n"
        " WHERE i < 200) SELECT randomblob(10000) FROM n");
    for (const std::string file : {"database.db", "database.db-journal"}) {
      fs::copy_file(work / file, journal / file);
    }
    sqlite.exec("ROLLBACK");
  }
  ASSERT_GT(fs::file_size(journal / "database.db-journal"), 0u);
  ExpectRefusedAndUnchanged(journal);
}

}  // namespace
}  // namespace velamap
