#include "reconstruct/registration/registration.h"

#include <algorithm>

namespace velamap {

int Registration::NumRegistered() const {
  return static_cast<int>(std::count_if(frames.begin(), frames.end(), [](const auto& frame) {
    return frame.cam_from_shape.has_value();
  }));
}

}  // namespace velamap
