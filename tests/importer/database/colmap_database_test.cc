#include "importer/database/colmap_database.h"

#include <filesystem>
#include <iterator>
#include <map>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "tests/importer/marker_builders.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using Mode = ColmapDatabase::Mode;

const Camera kCamera{CameraModel::kOpenCV, 1920, 1080, {1400.1, 1410, 960, 540, .1, .2, .3, .4}};

FrameDetections SomeDetections(const std::string& name) {
  FrameDetections detections;
  detections.image_name = name;
  detections.markers = {SquareMarker(2, 100.123456789, 50), SquareMarker(79, 300, 1.0 / 3.0)};
  detections.markers[0].part = "sail";
  detections.markers[0].colors[3] = {1, 20, 255};
  detections.markers[0].corner_sigma_px = {0.01, 0.02, 1.0 / 30, 0.04};
  detections.markers[1].is_fallback = true;
  detections.rejected = {{SquareMarker(5, 700, 700), "not in layout"}};
  return detections;
}

int NumFiles(const TempDir& dir) {
  return static_cast<int>(std::distance(fs::directory_iterator(dir.path()), {}));
}

template <typename T>
std::vector<T> Blob(const SQLite::Column& column) {
  const T* begin = static_cast<const T*>(column.getBlob());
  return {begin, begin + static_cast<std::size_t>(column.getBytes()) / sizeof(T)};
}

void ExpectEqual(const MarkerDetection& a, const MarkerDetection& b) {
  EXPECT_EQ(a.marker_id, b.marker_id);
  EXPECT_EQ(a.corners_in_image_px, b.corners_in_image_px);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.part, b.part);
  EXPECT_EQ(a.corner_sigma_px, b.corner_sigma_px);
  EXPECT_EQ(a.is_fallback, b.is_fallback);
}

TEST(ColmapDatabase, RoundTrip) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  FrameDetections video_frame = SomeDetections("frame_000012.jpg");
  video_frame.frame_number = 12;
  video_frame.time_s = 0.48;
  const FrameDetections photograph = SomeDetections("sub/photo.jpg");
  FrameDetections nothing;
  nothing.image_name = "nothing.jpg";
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    EXPECT_FALSE(database.ReadDetector());
    const CameraId camera_id = database.AddCamera(kCamera);
    EXPECT_EQ(database.AddCamera(kCamera), camera_id);
    EXPECT_EQ(database.AddImage(camera_id, video_frame, "how"), 1u);
    EXPECT_EQ(database.AddImage(camera_id, photograph, "how"), 2u);
    EXPECT_EQ(database.AddImage(camera_id, nothing, "how"), 3u);
  }
  EXPECT_EQ(NumFiles(dir), 1) << "a journal was left behind";
  const ColmapDatabase database(path, Mode::kReadOnly);
  EXPECT_EQ(database.ReadCameras(), (std::map<CameraId, Camera>{{1, kCamera}}));
  EXPECT_EQ(database.ReadDetector(), "how");
  EXPECT_EQ(database.ReadImageIdsByName().at("sub/photo.jpg"), 2u);
  const std::vector<DatabaseImage> images = database.ReadImages();
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(images[0].detections.frame_number, 12);
  EXPECT_EQ(images[0].detections.time_s, 0.48);
  EXPECT_FALSE(images[1].detections.frame_number);
  EXPECT_FALSE(images[1].detections.time_s);
  for (int i = 0; i < 2; ++i) {
    const DatabaseImage& image = images[static_cast<std::size_t>(i)];
    EXPECT_EQ(image.camera_id, 1u);
    ASSERT_EQ(image.detections.markers.size(), 2u);
    ExpectEqual(image.detections.markers[0], photograph.markers[0]);
    ExpectEqual(image.detections.markers[1], photograph.markers[1]);
    ASSERT_EQ(image.detections.rejected.size(), 1u);
    EXPECT_EQ(image.detections.rejected[0].reason, "not in layout");
    ExpectEqual(image.detections.rejected[0].detection, photograph.rejected[0].detection);
  }
  EXPECT_TRUE(images[2].detections.markers.empty());
}

TEST(ColmapDatabase, IsWhatSqliteAndColmapExpect) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    const CameraId camera_id = database.AddCamera(kCamera);
    database.AddImage(camera_id, SomeDetections("a.jpg"), "how");
    database.AddImage(camera_id, SomeDetections("b.jpg"), "how");
    database.WriteMatches(2, 1, {{0, 4}, {1, 5}});
  }
  SQLite::Database sqlite(path);
  EXPECT_EQ(sqlite.execAndGet("PRAGMA integrity_check").getString(), "ok");
  EXPECT_EQ(sqlite.execAndGet("PRAGMA user_version").getInt(), 3800);
  SQLite::Statement foreign_keys(sqlite, "PRAGMA foreign_key_check");
  EXPECT_FALSE(foreign_keys.executeStep());
  EXPECT_EQ(sqlite.execAndGet("SELECT prior_focal_length FROM cameras").getInt(), 1);

  SQLite::Statement keypoints(sqlite, "SELECT rows, cols, data FROM keypoints WHERE image_id = 1");
  ASSERT_TRUE(keypoints.executeStep());
  EXPECT_EQ(keypoints.getColumn(0).getInt(), 8);
  EXPECT_EQ(keypoints.getColumn(1).getInt(), 2);
  const std::vector<float> x = Blob<float>(keypoints.getColumn(2));
  ASSERT_EQ(x.size(), 16u);
  EXPECT_EQ(x[0], static_cast<float>(90.123456789));
  EXPECT_EQ(x[1], 40.0f);
  SQLite::Statement descriptors(
      sqlite, "SELECT rows, cols, length(data) FROM descriptors WHERE image_id=1");
  ASSERT_TRUE(descriptors.executeStep());
  EXPECT_EQ(descriptors.getColumn(0).getInt(), 8);
  EXPECT_EQ(descriptors.getColumn(1).getInt(), 128);
  EXPECT_EQ(descriptors.getColumn(2).getInt(), 8 * 128);
  EXPECT_EQ(sqlite
                .execAndGet("SELECT first_keypoint_idx FROM marker_detections WHERE image_id = 1"
                            " AND marker_id = 79")
                .getInt(),
            4);
}

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
    database.AddImage(database.AddCamera(kCamera), SomeDetections("a.jpg"), "how");
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

// A video of a hundred frames with fifty markers: SQLite takes a third, and no text is repeated.
TEST(ColmapDatabase, TakesLittleMoreThanItsNumbers) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  constexpr int kNumImages = 100, kNumMarkers = 50;
  const std::string detector(168, 'd');
  FrameDetections detections;
  for (int id = 0; id < kNumMarkers; ++id) detections.markers.push_back(SquareMarker(id, 9, 9));
  FeatureMatches matches;
  for (std::uint32_t i = 0; i < 4 * kNumMarkers; ++i) matches.emplace_back(i, i);
  std::uintmax_t num_bytes = 0;
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    ColmapDatabase::Transaction transaction(&database);
    const CameraId camera_id = database.AddCamera(kCamera);
    for (int i = 0; i < kNumImages; ++i) {
      detections.image_name = std::to_string(i);
      database.AddImage(camera_id, detections, detector);
      num_bytes += kNumMarkers * (4 * (8 + 128) + 64 + 12);
    }
    for (ImageId i = 1; i < kNumImages; ++i) {
      database.WriteMatches(i, i + 1, matches);
      num_bytes += 2 * 8 * matches.size();
    }
    transaction.Commit();
  }
  EXPECT_LT(static_cast<double>(fs::file_size(path)), 1.4 * static_cast<double>(num_bytes));
  EXPECT_EQ(SQLite::Database(path).execAndGet("PRAGMA integrity_check").getString(), "ok");
}

TEST(ColmapDatabase, UnknownSigmasAreNull) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(database.AddCamera(kCamera), SomeDetections("a.jpg"), "how");
  }
  SQLite::Database sqlite(path);
  SQLite::Statement query(sqlite,
                          "SELECT corner_sigmas, is_fallback FROM marker_detections"
                          " WHERE marker_id IN (2, 79) ORDER BY marker_id");
  ASSERT_TRUE(query.executeStep());
  EXPECT_EQ(Blob<double>(query.getColumn(0)), (std::vector<double>{0.01, 0.02, 1.0 / 30, 0.04}));
  EXPECT_EQ(query.getColumn(1).getInt(), 0);
  ASSERT_TRUE(query.executeStep());
  EXPECT_TRUE(query.isColumnNull(0));
  EXPECT_EQ(query.getColumn(1).getInt(), 1);
}

TEST(ColmapDatabase, ReplacedDetectionsTakeTheMatchesOfTheirImageAlong) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  FrameDetections more = SomeDetections("a.jpg");
  more.markers.insert(more.markers.begin() + 1, SquareMarker(5, 700, 700));
  more.rejected.clear();
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    const CameraId camera_id = database.AddCamera(kCamera);
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) {
      database.AddImage(camera_id, SomeDetections(name), "how");
    }
    for (const auto& [id1, id2] : {std::pair(1, 2), std::pair(2, 3), std::pair(1, 3)}) {
      database.WriteMatches(id1, id2, {{0, 0}});
    }
    database.ReplaceDetections(1, more, "how");
    EXPECT_FALSE(database.HasMatches(1, 2));
    EXPECT_FALSE(database.HasMatches(1, 3));
    EXPECT_TRUE(database.HasMatches(2, 3));
  }
  const std::vector<DatabaseImage> images = ColmapDatabase(path, Mode::kReadOnly).ReadImages();
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(images[0].detections.image_name, "a.jpg");
  ASSERT_EQ(images[0].detections.markers.size(), 3u);
  ExpectEqual(images[0].detections.markers[1], more.markers[1]);
  EXPECT_TRUE(images[0].detections.rejected.empty());
  EXPECT_EQ(images[1].detections.markers.size(), 2u);
  SQLite::Database sqlite(path);
  EXPECT_EQ(sqlite.execAndGet("SELECT rows FROM keypoints WHERE image_id = 1").getInt(), 12);
  EXPECT_EQ(sqlite.execAndGet("SELECT rows FROM descriptors WHERE image_id = 1").getInt(), 12);
  EXPECT_EQ(sqlite.execAndGet("SELECT count(*) FROM matches").getInt(), 1);
}

TEST(ColmapDatabase, PairIdAndColumnsFollowTheSmallerImageId) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    EXPECT_FALSE(database.HasMatches(3, 7));
    database.WriteMatches(7, 3, {{70, 30}, {71, 31}});
    EXPECT_TRUE(database.HasMatches(3, 7));
    EXPECT_TRUE(database.HasMatches(7, 3));
    database.WriteMatches(3, 7, {{30, 70}, {31, 71}, {32, 72}});  // replaces
  }
  SQLite::Database sqlite(path);
  for (const char* table : {"matches", "two_view_geometries"}) {
    SQLite::Statement query(sqlite, std::string("SELECT pair_id, rows, cols, data FROM ") + table);
    ASSERT_TRUE(query.executeStep());
    EXPECT_EQ(query.getColumn(0).getInt64(), 2147483647LL * 3 + 7);
    EXPECT_EQ(query.getColumn(1).getInt(), 3);
    EXPECT_EQ(query.getColumn(2).getInt(), 2);
    EXPECT_EQ(Blob<std::uint32_t>(query.getColumn(3)),
              (std::vector<std::uint32_t>{30, 70, 31, 71, 32, 72}));
    EXPECT_FALSE(query.executeStep());
  }
  SQLite::Statement geometry(sqlite, "SELECT config, F, E, H, qvec, tvec FROM two_view_geometries");
  ASSERT_TRUE(geometry.executeStep());
  EXPECT_EQ(geometry.getColumn(0).getInt(), 2);
  for (int i = 1; i <= 5; ++i) EXPECT_TRUE(geometry.getColumn(i).isNull());
}

TEST(ColmapDatabase, RollbackLeavesNothing) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  ColmapDatabase database(path, Mode::kReadWriteCreate);
  const CameraId camera_id = database.AddCamera(kCamera);
  {
    const ColmapDatabase::Transaction transaction(&database);
    database.AddImage(camera_id, SomeDetections("a.jpg"), "how");
  }
  EXPECT_TRUE(database.ReadImageIdsByName().empty());
  EXPECT_FALSE(database.ReadDetector());
  {
    ColmapDatabase::Transaction transaction(&database);
    database.AddImage(camera_id, SomeDetections("a.jpg"), "how");
    transaction.Commit();
  }
  EXPECT_EQ(database.ReadImages().size(), 1u);
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
    database.AddImage(database.AddCamera(kCamera), SomeDetections("a.jpg"), "how");
  }
  {
    SQLite::Database sqlite(path, SQLite::OPEN_READWRITE);
    EXPECT_EQ(sqlite.execAndGet("PRAGMA journal_mode=WAL").getString(), "wal");
  }
  { EXPECT_EQ(ColmapDatabase(path, Mode::kReadOnly).ReadImages().size(), 1u); }
  EXPECT_EQ(NumFiles(dir), 1);
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    database.AddImage(database.AddCamera(kCamera), SomeDetections("b.jpg"), "how");
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
    database.AddImage(database.AddCamera(kCamera), SomeDetections("a.jpg"), "how");
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
    database.AddImage(database.AddCamera(kCamera), SomeDetections("b.jpg"), "how");
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
