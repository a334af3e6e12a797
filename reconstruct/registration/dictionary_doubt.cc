#include "reconstruct/registration/dictionary_doubt.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

namespace velamap {

std::string DictionaryDoubt(const std::vector<DatabaseImage>& images) {
  // With fewer markers, an image can hardly be placed relative to the others.
  constexpr double kFewMarkersPerImage = 3.0;
  std::map<int, int> num_images_of;  // by id
  std::size_t num_detections = 0, num_images = 0;
  for (const DatabaseImage& image : images) {
    std::set<int> ids;
    for (const MarkerDetection& marker : image.detections.markers) ids.insert(marker.marker_id);
    for (const int id : ids) ++num_images_of[id];
    num_detections += ids.size();
    num_images += !ids.empty();
  }
  if (num_images < 2) return {};
  const auto num_single = static_cast<std::size_t>(
      std::count_if(num_images_of.begin(), num_images_of.end(),
                    [](const auto& id_and_count) { return id_and_count.second == 1; }));
  if (2 * num_single > num_images_of.size()) {
    return fmt::format("{} of {} ids are seen in only one of the {} images", num_single,
                       num_images_of.size(), num_images);
  }
  const double per_image = static_cast<double>(num_detections) / static_cast<double>(num_images);
  if (per_image >= kFewMarkersPerImage) return {};
  return fmt::format("{} images hold {:.1f} markers each on average", num_images, per_image);
}

}  // namespace velamap
