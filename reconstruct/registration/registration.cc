#include "reconstruct/registration/registration.h"

#include <algorithm>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {

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
    frame->reason =
        fmt::format("shares {} of its {} markers with the registered images; {} are needed",
                    num_shared, num_markers, needed);
    return;
  }
  frame->reason =
      fmt::format("its {} shared markers do not agree on a position of the camera", num_shared);
  frame->num_contradicting = num_shared;
}

std::string CameraDoubt(const Registration& registration) {
  constexpr int kManyMarkers = 8;  // more than chance or false detections spoil
  constexpr int kMinShare_percent = 20;
  const auto num_contradicting = static_cast<int>(std::count_if(
      registration.frames.begin(), registration.frames.end(),
      [](const RegisteredFrame& frame) { return frame.num_contradicting >= kManyMarkers; }));
  const int num_frames = registration.NumRegistered() + num_contradicting;
  if (num_contradicting == 0 || 100 * num_contradicting < kMinShare_percent * num_frames) return "";
  return fmt::format(
      "{} of {} images show {} or more markers of the shape but fit no position of the camera: "
      "they are of another camera, lens mode or zoom, or the surface moved; give only images of "
      "one camera and one state",
      num_contradicting, num_frames, kManyMarkers);
}

}  // namespace velamap
