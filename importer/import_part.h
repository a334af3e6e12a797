// The import of a long video in parts, each by a job of its own into a database of its own, which
// MergeDatabases() (database_merger.h) puts together. The result is that of one import, row for
// row:
//
//   tracking   starts again with every group of frames (track/marker_tracking.h), and a part is a
//              number of whole groups
//   formation  what camera and print do to edges is estimated from the beginning of the whole video
//              in every part
//   the rest   rotations that other frames decide, and matches, need all frames: the merge does
//   them

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

// The frames of one part of the frames that `whole` selects: groups are shared out evenly in order,
// and the last part reaches to the end of the video, however many frames the container states.
// Nothing for a part that has no group, because the video has fewer groups than parts. `num_frames`
// is the number that `whole` selects, at least about.
std::optional<VideoOptions> FramesOfPart(const VideoPart& part, const VideoOptions& whole,
                                         int num_frames, std::int64_t frames_per_group);

// The frames that an import searches: those of options.part, or all. Throws InputError for a part
// of photographs, and of a video that does not state how many frames it has.
std::optional<VideoOptions> FramesToSearch(const MarkerImporterOptions& options);

// Throws InputError if `database` holds a part while options.part is another one or none, or the
// other way round.
void CheckPart(const MarkerImporterOptions& options, const ColmapDatabase& database);

// Notes which part a database holds, if options.part is one.
void NotePart(const MarkerImporterOptions& options, const std::string& detector, bool is_finished,
              ColmapDatabase* database);

}  // namespace velamap
