#include "reconstruct/registration/registration.h"

#include <algorithm>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr int kManyMarkers = 8;  // more than chance or false detections spoil

}  // namespace

int Registration::NumRegistered() const {
  return static_cast<int>(std::count_if(frames.begin(), frames.end(), [](const auto& frame) {
    return frame.cam_from_shape.has_value();
  }));
}

void CheckEnoughImages(std::size_t num_images, std::size_t needed) {
  if (num_images >= needed) return;
  throw DataError(
      fmt::format("a shape needs at least {} with markers; the database has {}; take pictures from "
                  "several positions",
                  needed == 1 ? "one image" : "two images", num_images));
}

void ExplainWhyNotRegistered(int num_shared, int num_markers, int needed, RegisteredFrame* frame) {
  if (num_shared < needed) {
    frame->left_out.reason =
        fmt::format("shares {} of its {} markers with the registered images; {} are needed",
                    num_shared, num_markers, needed);
    return;
  }
  frame->left_out.reason =
      fmt::format("its {} shared markers do not agree on a position of the camera", num_shared);
  frame->num_contradicting = num_shared;
}

void CountContradictions(RegisteredFrame* frame) {
  constexpr std::size_t kMinShare_percent = 25;
  const std::size_t num_outliers = frame->outliers.size();
  const auto num_own =
      static_cast<int>(std::count_if(frame->outliers.begin(), frame->outliers.end(),
                                     [](const auto& outlier) { return !outlier.is_dropped; }));
  const bool are_many =
      num_own >= kManyMarkers &&
      100 * num_outliers >= kMinShare_percent * (num_outliers + frame->marker_ids.size());
  frame->num_contradicting = are_many ? num_own : 0;
}

std::string CameraDoubt(const Registration& registration) {
  constexpr int kMinShare_percent = 20;
  int num_contradicting = 0, num_frames = 0;
  for (const RegisteredFrame& frame : registration.frames) {
    const bool contradicts = frame.num_contradicting >= kManyMarkers;
    const bool is_removed = frame.left_out.cause == LeftOut::Cause::kAddsLittle;
    num_contradicting += contradicts;
    num_frames += contradicts || frame.cam_from_shape || is_removed;
  }
  if (num_contradicting == 0 || 100 * num_contradicting < kMinShare_percent * num_frames) return "";
  return fmt::format(
      "{} of {} images show {} or more markers of the shape that contradict the other images: "
      "they are of another camera, lens mode or zoom, or the surface moved; give only images of "
      "one camera and one state",
      num_contradicting, num_frames, kManyMarkers);
}

}  // namespace velamap
