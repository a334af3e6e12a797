#include "workflows/check/marked_frame.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

#include "importer/base/statistics.h"
#include "importer/geometry/quad.h"

namespace velamap {

void DrawMarkers(const FrameDetections& detections, cv::Mat* image) {
  constexpr double kReadableSidePx = 40.0;
  constexpr int kMaxWidthPx = 4000, kThickness = 2;
  std::vector<double> sides_px;
  for (const MarkerDetection& marker : detections.markers) {
    sides_px.push_back(QuadMeanSide(marker.corners_in_image_px));
  }
  const double side_px = sides_px.empty() ? kReadableSidePx : Median(std::move(sides_px));
  const double factor =
      std::clamp(kReadableSidePx / side_px, 1.0, std::max(1.0, double(kMaxWidthPx) / image->cols));
  cv::resize(*image, *image, {}, factor, factor, cv::INTER_LINEAR);
  const auto draw = [&](const MarkerDetection& marker, const cv::Scalar& color) {
    std::vector<cv::Point> outline;
    for (const Eigen::Vector2d& x_px : marker.corners_in_image_px) {
      outline.emplace_back(static_cast<int>(factor * x_px.x()),
                           static_cast<int>(factor * x_px.y()));
    }
    cv::polylines(*image, outline, true, color, kThickness, cv::LINE_AA);
    const double font_scale =
        std::clamp(factor * QuadMeanSide(marker.corners_in_image_px) / 70.0, 0.35, 2.0);
    cv::putText(*image, std::to_string(marker.marker_id), outline[0] - cv::Point(0, 4),
                cv::FONT_HERSHEY_SIMPLEX, font_scale, color, font_scale < 0.8 ? 1 : 2, cv::LINE_AA);
  };
  for (const MarkerDetection& marker : detections.markers) draw(marker, {80, 200, 0});
  for (const RejectedDetection& rejected : detections.rejected) {
    draw(rejected.detection, {40, 40, 230});
  }
}

}  // namespace velamap
