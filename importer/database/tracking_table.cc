#include "importer/database/tracking_table.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/database/sqlite_blob.h"

namespace velamap {
namespace {

constexpr char kSchema[] = R"(
CREATE TABLE IF NOT EXISTS marker_tracking (
    first_frame INTEGER NOT NULL,
    frame_step INTEGER NOT NULL,
    last_frame INTEGER NOT NULL,
    num_frames INTEGER NOT NULL,
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
DELETE FROM marker_tracking;
DELETE FROM marker_tracks;
)";

constexpr char kReadState[] =
    "SELECT first_frame, frame_step, last_frame, num_frames, tracked_frame, has_new, inflow_px"
    " FROM marker_tracking";
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

// Reads the columns of a row, and notes whether they are what a tracking gives.
class RowReader {
 public:
  explicit RowReader(SQLite::Statement* row) : row_(row) {}

  int Int(int column, int min) {
    const std::int64_t value = row_->getColumn(column).getInt64();
    Require(value >= min && value <= kMaxInt);
    return static_cast<int>(value);
  }

  double Double(int column, double min, double max) {
    const double value = row_->getColumn(column).getDouble();
    Require(value >= min && value <= max);
    return value;
  }

  std::vector<double> Pixels(int column) {
    std::vector<double> values = ReadBlob<double>(row_->getColumn(column));
    Require(std::all_of(values.begin(), values.end(),
                        [](double value) { return std::abs(value) <= kMaxPx; }));
    return values;
  }

  void Require(bool condition) { is_valid_ = is_valid_ && condition; }
  bool IsValid() const { return is_valid_; }

 private:
  static constexpr std::int64_t kMaxInt = 1 << 30;
  static constexpr double kMaxPx = 1e6;

  SQLite::Statement* row_;
  bool is_valid_ = true;
};

// Nothing for a row that no tracking gives.
std::optional<MarkerTrack> TrackOf(SQLite::Statement* row) {
  RowReader reader(row);
  MarkerTrack track;
  track.marker_id = reader.Int(0, 0);
  const std::vector<double> corners = reader.Pixels(1), velocity = reader.Pixels(2);
  track.num_lost = reader.Int(3, 0);
  track.num_found = reader.Int(4, 0);
  track.hit_rate = reader.Double(5, 0, 1);
  if (corners.size() != 2 * kNumCorners || (velocity.size() != 2 && !velocity.empty()) ||
      !reader.IsValid()) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    track.corners_px[i] = {corners[2 * i], corners[2 * i + 1]};
  }
  if (!velocity.empty()) track.velocity_px = Eigen::Vector2d(velocity[0], velocity[1]);
  return track;
}

std::optional<TrackingState> StateOf(SQLite::Statement* row) {
  RowReader reader(row);
  TrackingState state;
  state.first_frame = reader.Int(0, 0);
  state.frame_step = reader.Int(1, 1);
  state.last_frame = reader.Int(2, 0);
  state.num_frames = reader.Int(3, 0);
  state.tracks.frame_number = reader.Int(4, 0);
  state.tracks.has_new = reader.Int(5, 0) != 0;
  const std::vector<double> inflow = reader.Pixels(6);
  if (inflow.size() != state.tracks.inflow_px.size() || !reader.IsValid()) return std::nullopt;
  std::copy(inflow.begin(), inflow.end(), state.tracks.inflow_px.begin());
  return state;
}

}  // namespace

void WriteTracking(const TrackingState& state, SQLite::Database* database) {
  database->exec(kSchema);
  SQLite::Statement insert(*database,
                           "INSERT INTO marker_tracking(first_frame, frame_step, last_frame,"
                           " num_frames, tracked_frame, has_new, inflow_px)"
                           " VALUES(?, ?, ?, ?, ?, ?, ?)");
  SQLite::bind(insert, state.first_frame, state.frame_step, state.last_frame, state.num_frames,
               state.tracks.frame_number, state.tracks.has_new ? 1 : 0);
  BindBlob(insert, 7,
           std::vector<double>(state.tracks.inflow_px.begin(), state.tracks.inflow_px.end()));
  insert.exec();
  SQLite::Statement insert_track(*database,
                                 "INSERT INTO marker_tracks(marker_id, corners_px, velocity_px,"
                                 " num_lost, num_found, hit_rate) VALUES(?, ?, ?, ?, ?, ?)");
  for (const MarkerTrack& track : state.tracks.tracks) InsertTrack(track, &insert_track);
}

std::optional<TrackingState> ReadTracking(const std::string& path, SQLite::Database* database) {
  if (!database->tableExists("marker_tracking") || !database->tableExists("marker_tracks")) {
    return std::nullopt;
  }
  const auto fail = [&](const char* table) {
    throw InputError(
        fmt::format("{}: table {} holds values that no tracking of markers gives; delete the "
                    "database and import again",
                    path, table));
  };
  SQLite::Statement states(*database, kReadState);
  if (!states.executeStep()) return std::nullopt;
  std::optional<TrackingState> state = StateOf(&states);
  if (!state) fail("marker_tracking");
  SQLite::Statement tracks(*database, kReadTracks);
  while (tracks.executeStep()) {
    const std::optional<MarkerTrack> track = TrackOf(&tracks);
    if (!track) fail("marker_tracks");
    state->tracks.tracks.push_back(*track);
  }
  return state;
}

}  // namespace velamap
