#include "importer/continued_tracking.h"

#include <cstdint>
#include <optional>

#include "importer/base/files.h"
#include "importer/video/frame_source.h"

namespace velamap {

TrackingState ContinuedTracking(const MarkerImporterOptions& options,
                                const ColmapDatabase& database) {
  TrackingState first;
  first.first_frame = options.video.first_frame;
  first.frame_step = options.video.frame_step;
  if (IsFolder(options.image_path)) return first;
  const std::optional<TrackingState> known = database.ReadTracking();
  const bool is_same =
      known && known->first_frame == first.first_frame && known->frame_step == first.frame_step;
  return is_same ? *known : first;
}

std::vector<std::string> WithSearchedFrames(std::vector<std::string> known_names,
                                            const TrackingState& tracking) {
  for (std::int64_t number = tracking.first_frame; number <= tracking.last_frame;
       number += tracking.frame_step) {
    known_names.push_back(NameOfVideoFrame(static_cast<int>(number)));
  }
  return known_names;
}

}  // namespace velamap
