#include "importer/database/colmap_database.h"

#include <filesystem>
#include <map>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "tests/importer/database/database_builders.h"

namespace velamap {
namespace {

namespace fs = std::filesystem;
using Mode = ColmapDatabase::Mode;

template <typename T>
std::vector<T> Blob(const SQLite::Column& column) {
  const T* begin = static_cast<const T*>(column.getBlob());
  return {begin, begin + static_cast<std::size_t>(column.getBytes()) / sizeof(T)};
}

// SQLite would take these names for a database in memory and for an address.
TEST(ColmapDatabase, AnyNameIsThatOfAFile) {
  const TempDir dir;
  const fs::path before = fs::current_path();
  fs::current_path(dir.path());
  for (const char* name : {":memory:", "file:a.db?mode=memory", "file::memory:"}) {
    {
      ColmapDatabase database(name, Mode::kReadWriteCreate);
      database.AddCamera(kDatabaseCamera, true);
    }
    EXPECT_TRUE(fs::is_regular_file(dir / name)) << name;
    EXPECT_EQ(ColmapDatabase(name, Mode::kReadOnly).ReadCameras().size(), 1u) << name;
  }
  EXPECT_EQ(NumFiles(dir), 3);
  fs::current_path(before);
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
    const CameraId camera_id = database.AddCamera(kDatabaseCamera);
    EXPECT_EQ(database.AddCamera(kDatabaseCamera), camera_id);
    EXPECT_EQ(database.AddImage(camera_id, video_frame, "how"), 1u);
    EXPECT_EQ(database.AddImage(camera_id, photograph, "how"), 2u);
    EXPECT_EQ(database.AddImage(camera_id, nothing, "how"), 3u);
  }
  EXPECT_EQ(NumFiles(dir), 1) << "a journal was left behind";
  const ColmapDatabase database(path, Mode::kReadOnly);
  EXPECT_EQ(database.ReadCameras(), (std::map<CameraId, Camera>{{1, kDatabaseCamera}}));
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
    const CameraId camera_id = database.AddCamera(kDatabaseCamera);
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
    const CameraId camera_id = database.AddCamera(kDatabaseCamera);
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
    database.AddImage(database.AddCamera(kDatabaseCamera), SomeDetections("a.jpg"), "how");
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
    const CameraId camera_id = database.AddCamera(kDatabaseCamera);
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
  const CameraId camera_id = database.AddCamera(kDatabaseCamera);
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

}  // namespace
}  // namespace velamap
