#include "workflows/check/clip_frames.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/parallel.h"

namespace velamap {
namespace {

// The distance of at most `max_num_frames` frames that are spread over `num_frames`.
int FrameStride(int num_frames, int max_num_frames) {
  return std::max(1, (num_frames + max_num_frames - 1) / max_num_frames);
}

}  // namespace

VideoOptions SpreadOverClip(const VideoOptions& video, int num_frames, int max_num_frames) {
  VideoOptions spread = video;
  spread.frame_step *= FrameStride(num_frames, max_num_frames);
  return spread;
}

ClipFrames ReadClipFrames(const std::string& image_path, const VideoOptions& video,
                          int max_num_frames, int num_threads) {
  ClipFrames clip;
  const std::unique_ptr<FrameSource> source = OpenFrameSource(image_path, video);
  clip.is_video = source->IsVideo();
  const int stride = clip.is_video ? 1 : FrameStride(source->NumFrames(), max_num_frames);
  for (int idx = 0; static_cast<int>(clip.frames.size()) < max_num_frames; ++idx) {
    std::optional<Frame> frame = source->Next();
    if (!frame) break;
    if (idx % stride == 0) clip.frames.push_back(std::move(*frame));
  }
  std::vector<std::string> reasons(clip.frames.size());
  ParallelFor(clip.frames.size(), num_threads,
              [&](std::size_t i) { source->Load(&clip.frames[i], &reasons[i]); });
  clip.num_damaged = static_cast<int>(std::count_if(
      clip.frames.begin(), clip.frames.end(), [](const Frame& frame) { return !frame.is_whole; }));
  const auto unreadable =
      std::stable_partition(clip.frames.begin(), clip.frames.end(),
                            [](const Frame& frame) { return !frame.gray.empty(); });
  clip.frames.erase(unreadable, clip.frames.end());
  if (clip.frames.empty()) {
    throw InputError(fmt::format("{}: no frame can be read{}", image_path,
                                 reasons.empty() ? "" : ": " + reasons.front()));
  }
  return clip;
}

}  // namespace velamap
