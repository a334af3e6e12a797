#include "reconstruct/registration/frame_window.h"

#include <algorithm>
#include <utility>

#include "reconstruct/registration/repeated_frames.h"

namespace velamap {
namespace {

// Over a longer time, a hand-held camera may have reversed its motion.
constexpr double kLongestStep_s = 0.15;
// Whether the second frame follows the first so soon that one path of a marker passes through both.
bool AreNear(const DatabaseImage& frame, const DatabaseImage& next) {
  const double step_s = *next.detections.time_s - *frame.detections.time_s;
  return step_s > 0 && step_s <= kLongestStep_s && frame.camera_id == next.camera_id;
}

}  // namespace

std::vector<Exposure> ExposuresOf(const std::vector<DatabaseImage>& images) {
  std::vector<const DatabaseImage*> frames;
  for (const DatabaseImage& image : images) {
    if (image.detections.time_s) frames.push_back(&image);
  }
  std::sort(frames.begin(), frames.end(), [](const DatabaseImage* a, const DatabaseImage* b) {
    return *a->detections.time_s < *b->detections.time_s;
  });
  const std::vector<bool> is_repeated = FindRepeatedFrames(frames);
  std::vector<Exposure> exposures;
  std::vector<TimedPlaces> tracks;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!is_repeated[i]) {
      if (i > 0) tracks.back().is_near_next = AreNear(*exposures.back().frames.front(), *frames[i]);
      exposures.emplace_back();
      tracks.push_back(PlacesOf(frames[i]->detections));
    }
    exposures.back().frames.push_back(frames[i]);
  }
  FillGaps(&tracks);
  for (std::size_t i = 0; i < exposures.size(); ++i) exposures[i].track = std::move(tracks[i]);
  return exposures;
}

FrameWindow WindowAround(const std::vector<Exposure>& exposures, std::size_t idx,
                         std::size_t reach) {
  std::size_t begin = idx, end = idx + 1;
  while (begin > 0 && begin + reach > idx && exposures[begin - 1].track.is_near_next) --begin;
  while (end < exposures.size() && end <= idx + reach && exposures[end - 1].track.is_near_next) {
    ++end;
  }
  FrameWindow window;
  for (std::size_t i = begin; i < end; ++i) {
    const TimedPlaces& track = exposures[i].track;
    window.push_back({&exposures[i].frames.front()->detections, &track.places,
                      track.time_s - exposures[idx].track.time_s});
  }
  return window;
}

}  // namespace velamap
