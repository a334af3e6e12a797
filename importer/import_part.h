// The import of a long video in parts, each by a separate job into a separate database.
// MergeDatabases() (database_merger.h) makes the same database from them, row for row, as a single
// import would, for these reasons:
//
//   tracking   starts again with every group of frames (track/marker_tracking.h), and a part
//              consists of whole groups
//   formation  every part estimates how camera and print change edges from the beginning of the
//              whole video
//   the rest   rotations that other frames decide, and matches, need all frames and are left to the
//              merge

#pragma once

#include <cstdint>
#include <optional>

#include "importer/database/colmap_database.h"
#include "importer/database/part_table.h"
#include "importer/detect/detection_options.h"
#include "importer/marker_importer.h"
#include "importer/video/video_options.h"

namespace velamap {

// The number of frames after which the tracking starts again.
std::int64_t FramesPerGroup(const ArucoDetectionOptions& detection);

// The frames of one part of the frames that `whole` selects. Groups are distributed evenly and in
// order, and the last part extends to the end of the video, even if the container states fewer
// frames. Empty for a part without a group, because the video has fewer groups than parts.
// `num_frames` is the approximate number of frames that `whole` selects.
std::optional<VideoOptions> FramesOfPart(const VideoPart& part, const VideoOptions& whole,
                                         int num_frames, std::int64_t frames_per_group);

// The frames that an import searches: those of options.part, or all. Throws InputError for a part
// of photographs, and of a video that does not state how many frames it has.
std::optional<VideoOptions> FramesToSearch(const MarkerImporterOptions& options);

// Throws InputError if an import of options.part, or of a whole source without it, must not add to
// `database`, because that holds another part, or a part of other frames.
void CheckPart(const MarkerImporterOptions& options, const ColmapDatabase& database);

// Records which part a database holds, if options.part is set.
void RecordPart(const MarkerImporterOptions& options, const std::string& detector, bool is_finished,
                ColmapDatabase* database);

}  // namespace velamap
