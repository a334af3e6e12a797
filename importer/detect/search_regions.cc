#include "importer/detect/search_regions.h"

#include <cmath>
#include <cstddef>

namespace velamap {

bool FitsIn(const Box& box, const cv::Size& size, double margin_px) {
  return box.min.x() >= -margin_px && box.min.y() >= -margin_px &&
         box.max.x() <= size.width - 1 + margin_px && box.max.y() <= size.height - 1 + margin_px;
}

cv::Rect PixelsAround(const Box& box, const cv::Size& size, double reach_px) {
  const cv::Point min(static_cast<int>(std::floor(box.min.x() - reach_px)),
                      static_cast<int>(std::floor(box.min.y() - reach_px)));
  const cv::Point max(static_cast<int>(std::ceil(box.max.x() + reach_px)) + 1,
                      static_cast<int>(std::ceil(box.max.y() + reach_px)) + 1);
  return cv::Rect(min, max) & cv::Rect({0, 0}, size);
}

double TotalAreaPx(const std::vector<cv::Rect>& regions) {
  double area = 0.0;
  for (const cv::Rect& region : regions) area += region.area();
  return area;
}

std::vector<cv::Rect> MergeRegions(std::vector<cv::Rect> regions) {
  for (bool merged = true; merged;) {
    merged = false;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      for (std::size_t j = i + 1; j < regions.size();) {
        const cv::Rect both = regions[i] | regions[j];
        if (both.area() <= regions[i].area() + regions[j].area() + kCallCostPx) {
          regions[i] = both;
          regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(j));
          merged = true;
        } else {
          ++j;
        }
      }
    }
  }
  return regions;
}

}  // namespace velamap
