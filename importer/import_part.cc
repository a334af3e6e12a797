#include "importer/import_part.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/files.h"
#include "importer/import_checks.h"
#include "importer/track/marker_tracking.h"
#include "importer/video/frame_source.h"

namespace velamap {
namespace {

std::string FramesText(const VideoOptions& video) {
  return fmt::format("frames {} to {} in steps of {}", video.first_frame,
                     video.last_frame < 0 ? "the end" : std::to_string(video.last_frame),
                     video.frame_step);
}

}  // namespace

std::int64_t FramesPerGroup(const ArucoDetectionOptions& detection) {
  return std::int64_t{kFullSearchesPerGroup} * detection.full_search_interval;
}

std::optional<VideoOptions> FramesOfPart(const VideoPart& part, const VideoOptions& whole,
                                         int num_frames, std::int64_t frames_per_group) {
  // The remainder belongs to the last group. Containers may be off by a frame or so, and no part
  // may begin at a frame that does not exist.
  const std::int64_t num_groups = std::max<std::int64_t>(1, num_frames / frames_per_group);
  const auto first_group_of = [&](int number) {
    return ((number - 1) * num_groups + part.count - 1) / part.count;
  };
  const auto frame_of_group = [&](std::int64_t group) {
    return static_cast<int>(whole.first_frame + group * frames_per_group * whole.frame_step);
  };
  const std::int64_t begin = first_group_of(part.number), end = first_group_of(part.number + 1);
  if (begin == end) return std::nullopt;
  VideoOptions frames = whole;
  frames.first_frame = frame_of_group(begin);
  if (end < num_groups) frames.last_frame = frame_of_group(end) - 1;
  return frames;
}

std::optional<VideoOptions> FramesToSearch(const MarkerImporterOptions& options) {
  if (!options.part) return options.video;
  const VideoPart& part = *options.part;
  if (IsFolder(options.image_path)) {
    throw InputError(
        fmt::format("{}: photographs have no parts, which velamap marker_importer --video_part {} "
                    "asks for; import several folders into one database instead",
                    options.image_path, PartText(part)));
  }
  const int num_frames =
      OpenFrameSource(options.image_path, options.video, {}, options.num_threads)->NumFrames();
  if (num_frames == 0) {
    throw InputError(fmt::format(
        "{}: the video does not state how many frames it has, so velamap marker_importer "
        "--video_part {} cannot divide it; import it as a whole, or copy it into another container "
        "with ffmpeg -i VIDEO -c copy copy.mp4",
        options.image_path, PartText(part)));
  }
  return FramesOfPart(part, options.video, num_frames, FramesPerGroup(options.detection));
}

void CheckPart(const MarkerImporterOptions& options, const ColmapDatabase& database) {
  const std::optional<PartRecord> known = database.ReadPart();
  if (!known && (!options.part || !database.ReadDetector())) return;
  if (!known) {
    throw InputError(fmt::format("{}: holds the import of a whole source, not part {}; {}",
                                 options.database_path, PartText(*options.part),
                                 kImportAnewRemedy));
  }
  const std::string known_part = PartText(known->part);
  if (!options.part || PartText(*options.part) != known_part) {
    throw InputError(
        fmt::format("{}: holds part {} of a video, to be merged with the others by velamap "
                    "database_merger; {}",
                    options.database_path, known_part, kImportAnewRemedy));
  }
  if (!(known->whole == options.video)) {
    throw InputError(fmt::format("{}: holds part {} of {}, this run is of {}; {}",
                                 options.database_path, known_part, FramesText(known->whole),
                                 FramesText(options.video), kImportAnewRemedy));
  }
}

void RecordPart(const MarkerImporterOptions& options, const std::string& detector, bool is_finished,
                ColmapDatabase* database) {
  if (!options.part) return;
  ColmapDatabase::Transaction transaction(database);
  database->WritePart({*options.part, options.video, detector, is_finished});
  transaction.Commit();
}

}  // namespace velamap
