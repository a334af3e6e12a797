// The result of detection in one image.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"
#include "importer/geometry/quad.h"

namespace velamap {

// One marker in one image. Corners are ordered top-left, top-right, bottom-right, bottom-left of
// the upright marker, in the image frame (px).
struct MarkerDetection {
  int marker_id = 0;
  std::array<Eigen::Vector2d, kNumCorners> corners_in_image_px;
  std::array<Rgb, kNumCorners> colors{};  // of the image at the corners
  std::string part{};                     // of the layout that names it; empty without a layout
  // 1 sigma of a coordinate from the noise of the image, px; 0 without an edge fit.
  std::array<double, kNumCorners> corner_sigma_px{};
  // The corner fit failed, and the corners come from cv::cornerSubPix.
  bool is_fallback = false;
};

// The reason for leaving out an id that the layout does not name.
inline constexpr char kNotInLayout[] = "not in layout";

struct RejectedDetection {
  MarkerDetection detection;
  std::string reason;
};

// All markers of one image; `markers` holds each id at most once, in ascending order.
struct FrameDetections {
  std::string image_name;           // relative to the image folder, as in COLMAP
  std::optional<int> frame_number;  // zero-based position in the video; none for photographs
  std::optional<double> time_s;     // presentation time in the video
  std::vector<MarkerDetection> markers;
  std::vector<RejectedDetection> rejected;
};

// Mean of the four corners: good enough to compare places in an image, in px.
inline Eigen::Vector2d CornerMean(const MarkerDetection& marker) {
  return QuadCenter(marker.corners_in_image_px);
}

}  // namespace velamap
