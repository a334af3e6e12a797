#include "reconstruct/registration/frame_order.h"

#include <algorithm>

#include "importer/base/error.h"

namespace velamap {

std::vector<const DatabaseImage*> CanonicalOrder(const std::vector<DatabaseImage>& images) {
  std::vector<const DatabaseImage*> ordered;
  for (const DatabaseImage& image : images) {
    if (!image.detections.markers.empty()) ordered.push_back(&image);
  }
  std::sort(ordered.begin(), ordered.end(), [](const DatabaseImage* a, const DatabaseImage* b) {
    const FrameDetections &da = a->detections, &db = b->detections;
    return std::make_pair(da.frame_number.value_or(-1), da.image_name) <
           std::make_pair(db.frame_number.value_or(-1), db.image_name);
  });
  return ordered;
}

bool UseTimeOrder(const std::vector<const DatabaseImage*>& images, FrameOrder order) {
  const bool all_numbered = std::all_of(images.begin(), images.end(), [](const DatabaseImage* i) {
    return i->detections.frame_number.has_value();
  });
  if (order == FrameOrder::kTime && !all_numbered) {
    throw InputError(OptionName(&RegistrationOptions::frame_order) +
                     " time: the database has images without frame numbers; use auto or unordered");
  }
  return !images.empty() &&
         (order == FrameOrder::kTime || (order == FrameOrder::kAuto && all_numbered));
}

int FindCentralFrame(const std::vector<const DatabaseImage*>& images,
                     const RegistrationOptions& options) {
  const std::string& name_or_number = options.central_frame;
  const auto error = [&name_or_number](const std::string& what) {
    return InputError(OptionName(&RegistrationOptions::central_frame) + " " + name_or_number +
                      ": " + what + "; leave the option out to let the best one be chosen");
  };
  for (std::size_t idx = 0; idx < images.size(); ++idx) {
    const FrameDetections& frame = images[idx]->detections;
    if (frame.image_name != name_or_number &&
        !(frame.frame_number && std::to_string(*frame.frame_number) == name_or_number)) {
      continue;
    }
    if (static_cast<int>(frame.markers.size()) < options.min_num_inliers) {
      throw error("holds " + std::to_string(frame.markers.size()) + " markers; " +
                  std::to_string(options.min_num_inliers) + " are needed");
    }
    return static_cast<int>(idx);
  }
  throw error("no image of that name or frame number holds markers");
}

}  // namespace velamap
