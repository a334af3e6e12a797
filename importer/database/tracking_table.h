// The tables marker_tracking and marker_tracks that velamap adds to COLMAP's: how far a video has
// been searched, and the tracks of its markers there, so that an interrupted import goes on as if
// it had not been interrupted. README.md of this folder describes the columns.
//
// Errors of SQLite arrive as SQLite::Exception; ColmapDatabase turns them into input errors.

#pragma once

#include <optional>
#include <string>

#include "importer/track/marker_tracking.h"

namespace SQLite {
class Database;
}

namespace velamap {

struct TrackingState {
  int first_frame = 0, frame_step = 1;  // of the VideoOptions
  int last_frame = -1;                  // number of the last frame that was reached
  int num_frames = 0;                   // reached so far, damaged ones included
  int num_damaged = 0;  // of num_frames: not searched, because the video is damaged there
  MarkerTracks tracks;  // state after last_frame
};

// Creates the tables if they are missing and replaces their rows.
void WriteTracking(const TrackingState& state, SQLite::Database* database);

// Returns nothing if no video was tracked, or if a version without num_damaged tracked it. Throws
// InputError, naming the path, for values that no tracking gives.
std::optional<TrackingState> ReadTracking(const std::string& path, SQLite::Database* database);

}  // namespace velamap
