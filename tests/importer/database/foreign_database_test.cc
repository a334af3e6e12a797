// Databases that another program or an earlier version has written, or that another program uses.

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "tests/importer/database/database_builders.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using Mode = ColmapDatabase::Mode;

// What earlier versions of velamap wrote: no columns for sigmas and fallbacks, and the detector in
// every row.
void MakeOlder(const std::string& path) {
  SQLite::Database sqlite(path, SQLite::OPEN_READWRITE);
  sqlite.exec("ALTER TABLE marker_detections ADD COLUMN detector TEXT NOT NULL DEFAULT 'how'");
  sqlite.exec("DROP TABLE marker_detector");
  sqlite.exec("ALTER TABLE marker_detections DROP COLUMN corner_sigmas");
  sqlite.exec("ALTER TABLE marker_detections DROP COLUMN is_fallback");
}

TEST(ColmapDatabase, OlderDetectionsAreReadAndAddedTo) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(database.AddCamera(kDatabaseCamera), SomeDetections("a.jpg"), "how");
  }
  MakeOlder(path);
  MarkerDetection unknown = SomeDetections("a.jpg").markers[0];
  unknown.corner_sigma_px = {};
  {
    const ColmapDatabase database(path, Mode::kReadOnly);
    EXPECT_EQ(database.ReadDetector(), "how");
    ExpectEqual(database.ReadImages().at(0).detections.markers.at(0), unknown);
    EXPECT_FALSE(database.ReadImages().at(0).detections.markers.at(1).is_fallback);
  }
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(1, SomeDetections("b.jpg"), "how");
  }
  EXPECT_EQ(ColmapDatabase(path, Mode::kReadOnly).ReadDetector(), "how");
  const std::vector<DatabaseImage> images = ColmapDatabase(path, Mode::kReadOnly).ReadImages();
  ASSERT_EQ(images.size(), 2u);
  ExpectEqual(images[0].detections.markers.at(0), unknown);
  ExpectEqual(images[1].detections.markers.at(0), SomeDetections("b.jpg").markers[0]);
  ExpectEqual(images[1].detections.markers.at(1), SomeDetections("b.jpg").markers[1]);
}

TEST(ColmapDatabase, WithoutDetectionsOfVelamapThereIsNothingToRead) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  { ColmapDatabase database(path, Mode::kReadWriteCreate); }
  SQLite::Database(path, SQLite::OPEN_READWRITE).exec("DROP TABLE marker_detections");
  const ColmapDatabase database(path, Mode::kReadOnly);
  ExpectThrows<InputError>([&] { database.ReadImages(); },
                           {path, "no marker detections", "marker_importer"});
}

TEST(ColmapDatabase, LockedDatabaseIsNamed) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  { ColmapDatabase database(path, Mode::kReadWriteCreate); }
  SQLite::Database other(path, SQLite::OPEN_READWRITE);
  other.exec("BEGIN EXCLUSIVE");
  ExpectThrows<InputError>([&] { ColmapDatabase(path, Mode::kReadWriteCreate, 20); },
                           {path, "locked by another program"});
}

TEST(ColmapDatabase, ReadsAWriteAheadDatabaseAndLeavesNoExtraFiles) {
  // COLMAP leaves its databases in this mode.
  const TempDir dir;
  const std::string path = dir / "database.db";
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(database.AddCamera(kDatabaseCamera), SomeDetections("a.jpg"), "how");
  }
  {
    SQLite::Database sqlite(path, SQLite::OPEN_READWRITE);
    EXPECT_EQ(sqlite.execAndGet("PRAGMA journal_mode=WAL").getString(), "wal");
  }
  { EXPECT_EQ(ColmapDatabase(path, Mode::kReadOnly).ReadImages().size(), 1u); }
  EXPECT_EQ(NumFiles(dir), 1);
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(database.AddCamera(kDatabaseCamera), SomeDetections("b.jpg"), "how");
  }
  EXPECT_EQ(NumFiles(dir), 1);
}

// The tables and columns that COLMAP 3.12 and 4.x add to a database that they open. Without a row
// in `frames` COLMAP makes each image a frame of its own, so none may come from us.
TEST(ColmapDatabase, AddsToADatabaseThatALaterColmapHasOpened) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(database.AddCamera(kDatabaseCamera), SomeDetections("a.jpg"), "how");
  }
  SQLite::Database(path, SQLite::OPEN_READWRITE)
      .exec(
          "CREATE TABLE rigs(rig_id INTEGER PRIMARY KEY, ref_sensor_id INTEGER NOT NULL,"
          " ref_sensor_type INTEGER NOT NULL);"
          "CREATE TABLE frames(frame_id INTEGER PRIMARY KEY, rig_id INTEGER NOT NULL);"
          "CREATE TABLE frame_data(frame_id INTEGER NOT NULL, data_id INTEGER NOT NULL,"
          " sensor_id INTEGER NOT NULL, sensor_type INTEGER NOT NULL);"
          "ALTER TABLE descriptors ADD COLUMN type INTEGER NOT NULL DEFAULT 0;"
          "ALTER TABLE two_view_geometries ADD COLUMN camera1 BLOB;"
          "PRAGMA user_version = 4020000");
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(database.AddCamera(kDatabaseCamera), SomeDetections("b.jpg"), "how");
    database.WriteMatches(1, 2, {{0, 0}});
    EXPECT_EQ(database.ReadImages().size(), 2u);
  }
  SQLite::Database sqlite(path);
  for (const char* table : {"images", "keypoints", "descriptors"}) {
    EXPECT_EQ(sqlite.execAndGet(std::string("SELECT count(*) FROM ") + table).getInt(), 2) << table;
  }
  for (const char* table : {"rigs", "frames", "frame_data"}) {
    EXPECT_EQ(sqlite.execAndGet(std::string("SELECT count(*) FROM ") + table).getInt(), 0) << table;
  }
}

}  // namespace
}  // namespace velamap
