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
      fmt::format("a shape needs at least two images with markers, the database has {}; take "
                  "pictures from several positions",
                  num_images));
}

std::string ReasonNotRegistered(int num_shared, int num_markers, int needed) {
  if (num_shared < needed) {
    return fmt::format("shares {} of its {} markers with the registered images, {} are needed",
                       num_shared, num_markers, needed);
  }
  return fmt::format("its {} shared markers do not agree on a position of the camera", num_shared);
}

}  // namespace velamap
