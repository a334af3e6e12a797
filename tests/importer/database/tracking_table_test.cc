#include "importer/database/tracking_table.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using Mode = ColmapDatabase::Mode;

TrackingState Example() {
  TrackingState state;
  state.first_frame = 10;
  state.frame_step = 2;
  state.last_frame = 110;
  state.num_frames = 51;
  state.num_damaged = 4;
  state.tracks.frame_number = 108;
  state.tracks.has_new = true;
  state.tracks.inflow_px = {0.1, -2.5, 1.0 / 3, 4};
  const QuadCorners corners_px = {Eigen::Vector2d(1.0 / 7, -3), Eigen::Vector2d(11, 0.5),
                                  Eigen::Vector2d(12, 13), Eigen::Vector2d(2, 14)};
  state.tracks.tracks = {{7, corners_px, Eigen::Vector2d(0.25, -1.0 / 9), 0, 40, 0.9},
                         {3, corners_px, std::nullopt, 12, 1, 0.25}};
  return state;
}

TEST(TrackingTable, GivesBackWhatWasWritten) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  const TrackingState written = Example();
  {
    ColmapDatabase database(path, Mode::kReadWriteCreate);
    EXPECT_FALSE(database.ReadTracking());
    database.WriteTracking({});
    database.WriteTracking(written);
  }
  const auto read = ColmapDatabase(path, Mode::kReadOnly).ReadTracking();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->first_frame, 10);
  EXPECT_EQ(read->frame_step, 2);
  EXPECT_EQ(read->last_frame, 110);
  EXPECT_EQ(read->num_frames, 51);
  EXPECT_EQ(read->num_damaged, 4);
  EXPECT_EQ(read->tracks.frame_number, 108);
  EXPECT_TRUE(read->tracks.has_new);
  EXPECT_EQ(read->tracks.inflow_px, written.tracks.inflow_px);
  ASSERT_EQ(read->tracks.tracks.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const MarkerTrack &track = read->tracks.tracks[i], &expected = written.tracks.tracks[i];
    EXPECT_EQ(track.marker_id, expected.marker_id);
    EXPECT_EQ(track.corners_px, expected.corners_px);
    EXPECT_EQ(track.velocity_px, expected.velocity_px);
    EXPECT_EQ(track.num_lost, expected.num_lost);
    EXPECT_EQ(track.num_found, expected.num_found);
    EXPECT_EQ(track.hit_rate, expected.hit_rate);
  }
}

TEST(TrackingTable, OneOfAnEarlierVersionIsReplaced) {
  const TempDir dir;
  const std::string path = dir / "database.db";
  ColmapDatabase(path, Mode::kReadWriteCreate).WriteTracking(Example());
  SQLite::Database(path, SQLite::OPEN_READWRITE)
      .exec("ALTER TABLE marker_tracking DROP COLUMN num_damaged");
  ColmapDatabase database(path, Mode::kReadWriteCreate);
  EXPECT_FALSE(database.ReadTracking());
  database.WriteTracking(Example());
  ASSERT_TRUE(database.ReadTracking());
  EXPECT_EQ(database.ReadTracking()->num_damaged, 4);
}

TEST(TrackingTable, ValuesThatNoTrackingGivesAreRefused) {
  for (const char* change :
       {"marker_tracking SET frame_step = 0", "marker_tracking SET num_frames = 1e300",
        "marker_tracking SET inflow_px = 'text'", "marker_tracks SET marker_id = -1",
        "marker_tracks SET corners_px = zeroblob(8)", "marker_tracks SET velocity_px = zeroblob(8)",
        "marker_tracks SET corners_px = randomblob(0)", "marker_tracks SET hit_rate = 9e999"}) {
    SCOPED_TRACE(change);
    const TempDir dir;
    const std::string path = dir / "database.db";
    ColmapDatabase(path, Mode::kReadWriteCreate).WriteTracking(Example());
    SQLite::Database(path, SQLite::OPEN_READWRITE).exec(std::string("UPDATE ") + change);
    const ColmapDatabase database(path, Mode::kReadOnly);
    ExpectThrows<InputError>([&] { database.ReadTracking(); }, {path, "table marker_track"});
  }
}

}  // namespace
}  // namespace velamap
