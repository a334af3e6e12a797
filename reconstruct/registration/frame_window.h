// The frames of a video around one of them, near enough for one path of a marker to pass through
// all.

#pragma once

#include <cstddef>
#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/registration/track_gaps.h"

namespace velamap {

// One exposure of the sensor: the frame that shows it, and those that repeat that frame.
struct Exposure {
  std::vector<const DatabaseImage*> frames;
  TimedPlaces track;  // of the first of the frames
};

// In the order of time. Photographs are left out.
std::vector<Exposure> ExposuresOf(const std::vector<DatabaseImage>& images);

struct TimedFrame {
  const FrameDetections* detections = nullptr;
  const MarkerPlaces* places = nullptr;  // also of markers that the frame lacks (track_gaps.h)
  double time_s = 0.0;                   // after the frame whose corners' motions are sought
};

// That frame and those around it, in the order of time.
using FrameWindow = std::vector<TimedFrame>;

// The frames within `reach` exposures of exposure `idx`, without any that is not near the next.
FrameWindow WindowAround(const std::vector<Exposure>& exposures, std::size_t idx,
                         std::size_t reach);

}  // namespace velamap
