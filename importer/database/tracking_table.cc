#include "importer/database/tracking_table.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>

#include "importer/database/checked_number.h"
#include "importer/database/colmap_schema.h"
#include "importer/database/sqlite_blob.h"

namespace velamap {
namespace {

constexpr char kTrackingSchema[] = R"(
DROP TABLE IF EXISTS marker_tracking;
CREATE TABLE marker_tracking (
    first_frame INTEGER NOT NULL,
    frame_step INTEGER NOT NULL,
    last_frame INTEGER NOT NULL,
    num_frames INTEGER NOT NULL,
    num_damaged INTEGER NOT NULL,
    tracked_frame INTEGER NOT NULL,
    has_new INTEGER NOT NULL,
    inflow_px BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS marker_tracks (
    marker_id INTEGER NOT NULL,
    corners_px BLOB NOT NULL,
    velocity_px BLOB NOT NULL,
    num_lost INTEGER NOT NULL,
    num_found INTEGER NOT NULL,
    hit_rate REAL NOT NULL);
DELETE FROM marker_tracks;
)";

constexpr char kReadState[] =
    "SELECT first_frame, frame_step, last_frame, num_frames, num_damaged, tracked_frame, has_new,"
    " inflow_px FROM marker_tracking";
constexpr char kReadTracks[] =
    "SELECT marker_id, corners_px, velocity_px, num_lost, num_found, hit_rate FROM marker_tracks"
    " ORDER BY rowid";

std::vector<double> Flat(const QuadCorners& corners) {
  std::vector<double> values;
  for (const Eigen::Vector2d& corner : corners) {
    values.insert(values.end(), {corner.x(), corner.y()});
  }
  return values;
}

void InsertTrack(const MarkerTrack& track, SQLite::Statement* insert) {
  insert->tryReset();
  insert->bind(1, track.marker_id);
  BindBlob(*insert, 2, Flat(track.corners_px));
  std::vector<double> velocity;
  if (track.velocity_px) velocity = {track.velocity_px->x(), track.velocity_px->y()};
  BindBlob(*insert, 3, velocity);
  insert->bind(4, track.num_lost);
  insert->bind(5, track.num_found);
  insert->bind(6, track.hit_rate);
  insert->exec();
}

// Reads the columns of a row; throws InputError for values that no tracking gives.
class RowReader {
 public:
  RowReader(const TablePlace& place, SQLite::Statement* row) : place_(place), row_(row) {}

  double Double(const char* column, double min, double max) const {
    return CheckedNumber(place_, column, FromTo(min, max), row_);
  }

  int Int(const char* column, int min) const {
    constexpr int kMax = 1 << 30;
    return static_cast<int>(Double(column, min, kMax));
  }

  // An array of `count` places or lengths; it may be empty if `is_optional`.
  std::vector<double> Pixels(const char* column, std::size_t count, bool is_optional) const {
    constexpr double kMaxPx = 1e6;
    std::vector<double> values = ReadBlob<double>(row_->getColumn(column));
    const bool are_possible = std::all_of(values.begin(), values.end(),
                                          [&](double value) { return std::abs(value) <= kMaxPx; });
    if (are_possible && (values.size() == count || (is_optional && values.empty()))) return values;
    ThrowDamagedTable(
        place_, fmt::format("{} is not an array of {} pixels up to {:g}", column, count, kMaxPx));
  }

 private:
  TablePlace place_;
  SQLite::Statement* row_;
};

MarkerTrack TrackOf(const RowReader& row) {
  MarkerTrack track;
  track.marker_id = row.Int("marker_id", 0);
  const std::vector<double> corners = row.Pixels("corners_px", 2 * kNumCorners, false);
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    track.corners_px[i] = {corners[2 * i], corners[2 * i + 1]};
  }
  const std::vector<double> velocity = row.Pixels("velocity_px", 2, true);
  if (!velocity.empty()) track.velocity_px = Eigen::Vector2d(velocity[0], velocity[1]);
  track.num_lost = row.Int("num_lost", 0);
  track.num_found = row.Int("num_found", 0);
  track.hit_rate = row.Double("hit_rate", 0, 1);
  return track;
}

TrackingState StateOf(const RowReader& row) {
  TrackingState state;
  state.first_frame = row.Int("first_frame", 0);
  state.frame_step = row.Int("frame_step", 1);
  state.last_frame = row.Int("last_frame", 0);
  state.num_frames = row.Int("num_frames", 0);
  state.num_damaged = row.Int("num_damaged", 0);
  state.tracks.frame_number = row.Int("tracked_frame", 0);
  state.tracks.has_new = row.Int("has_new", 0) != 0;
  BorderInflow& inflow_px = state.tracks.inflow_px;
  const std::vector<double> values = row.Pixels("inflow_px", inflow_px.size(), false);
  std::copy(values.begin(), values.end(), inflow_px.begin());
  return state;
}

}  // namespace

void WriteTracking(const TrackingState& state, SQLite::Database* database) {
  database->exec(kTrackingSchema);
  SQLite::Statement insert(*database, "INSERT INTO marker_tracking VALUES(?, ?, ?, ?, ?, ?, ?, ?)");
  SQLite::bind(insert, state.first_frame, state.frame_step, state.last_frame, state.num_frames,
               state.num_damaged, state.tracks.frame_number, state.tracks.has_new ? 1 : 0);
  BindBlob(insert, 8,
           std::vector<double>(state.tracks.inflow_px.begin(), state.tracks.inflow_px.end()));
  insert.exec();
  SQLite::Statement insert_track(*database,
                                 "INSERT INTO marker_tracks(marker_id, corners_px, velocity_px,"
                                 " num_lost, num_found, hit_rate) VALUES(?, ?, ?, ?, ?, ?)");
  for (const MarkerTrack& track : state.tracks.tracks) InsertTrack(track, &insert_track);
}

std::optional<TrackingState> ReadTracking(const std::string& path, SQLite::Database* database) {
  if (ColumnNames(*database, "marker_tracking").count("num_damaged") == 0 ||
      !database->tableExists("marker_tracks"))
    return std::nullopt;
  SQLite::Statement states(*database, kReadState);
  if (!states.executeStep()) return std::nullopt;
  TrackingState state = StateOf({{path, "marker_tracking"}, &states});
  SQLite::Statement tracks(*database, kReadTracks);
  const RowReader track({path, "marker_tracks"}, &tracks);
  while (tracks.executeStep()) state.tracks.tracks.push_back(TrackOf(track));
  return state;
}

}  // namespace velamap
