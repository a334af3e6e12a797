#include "importer/detect/corner_colors.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace velamap {
namespace {

// The pixel in which an image position lies.
cv::Point PixelAt(const cv::Size& size, const Eigen::Vector2d& x_in_image_px) {
  return {std::clamp(static_cast<int>(std::floor(x_in_image_px.x())), 0, size.width - 1),
          std::clamp(static_cast<int>(std::floor(x_in_image_px.y())), 0, size.height - 1)};
}

}  // namespace

void AddColors(const Frame& frame, FrameDetections* detections) {
  std::vector<MarkerDetection*> markers;
  for (MarkerDetection& marker : detections->markers) markers.push_back(&marker);
  for (RejectedDetection& rejected : detections->rejected) markers.push_back(&rejected.detection);
  std::vector<cv::Point> pixels;
  for (const MarkerDetection* marker : markers) {
    for (const Eigen::Vector2d& corner : marker->corners_in_image_px) {
      pixels.push_back(PixelAt(frame.gray.size(), corner));
    }
  }
  std::vector<cv::Vec3b> colors;
  if (frame.picture) {
    colors = frame.picture->ColorsAt(pixels);
  } else {
    for (const cv::Point& pixel : pixels) colors.push_back(frame.color.at<cv::Vec3b>(pixel));
  }
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const cv::Vec3b& bgr = colors[i];
    markers[i / kNumCorners]->colors[i % kNumCorners] = {bgr[2], bgr[1], bgr[0]};
  }
}

}  // namespace velamap
