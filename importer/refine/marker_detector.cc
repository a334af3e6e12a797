#include "importer/refine/marker_detector.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "importer/base/log.h"
#include "importer/base/stage_timer.h"
#include "importer/camera/camera.h"
#include "importer/refine/read_again.h"
#include "importer/refine/saddle_corners.h"

namespace velamap {
namespace {

// The search window ends well within the cell that meets its neighbours at the corner.
QuadCorners RefineSubpix(const cv::Mat& gray, const QuadCorners& quad, int num_cells) {
  const double cell_px = QuadMeanSide(quad) / num_cells;
  const int half_window = std::clamp(static_cast<int>(std::lround(0.4 * cell_px)), 1, 5);
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& corner : quad) {
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  }
  cv::cornerSubPix(gray, points, cv::Size(half_window, half_window), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 0.01));
  QuadCorners refined;
  for (int c = 0; c < kNumCorners; ++c) refined[c] = {points[c].x, points[c].y};
  return refined;
}

}  // namespace

std::vector<MarkerDetection> DetectMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                           int border_bits, const ArucoDetectionOptions& options) {
  return RefineMarkers(gray, SearchMarkers(gray, dictionary, border_bits, options), dictionary,
                       border_bits, options);
}

std::vector<MarkerDetection> RefineMarkers(const cv::Mat& gray,
                                           const std::vector<MarkerQuad>& quads,
                                           const Dictionary& dictionary, int border_bits,
                                           const ArucoDetectionOptions& options,
                                           const ImageFormation& formation) {
  VELAMAP_CHECK(gray.type() == CV_8UC1);
  const cv::Mat dark_on_light = options.inverted ? cv::Mat(~gray) : gray;
  std::vector<MarkerDetection> detections;
  int num_fallbacks = 0;
  for (const MarkerQuad& found : quads) {
    const StageTimer timer(ImportStage::kRefine);
    ReadMarker read{found, {}};
    auto& [quad, refined] = read;
    const bool fits_edges = options.corner_refinement == CornerRefinement::kEdge;
    if (options.corner_refinement == CornerRefinement::kNone) {
      refined = RefinedCorners{found.corners_px};
    } else if (fits_edges) {
      read = RefineAndReadAgain(dark_on_light, found, dictionary, border_bits, formation);
    }
    const cv::Mat cells = MarkerCells(dictionary, quad.marker_id, border_bits);
    const bool is_fitted = refined.has_value();
    // What only an enlarged picture shows has to look like the whole marker.
    if (fits_edges && !is_fitted && quad.is_second_look) continue;
    if (!is_fitted) {
      refined = RefinedCorners{RefineSubpix(dark_on_light, quad.corners_px, cells.rows)};
    }
    MarkerDetection detection;
    detection.marker_id = quad.marker_id;
    if (fits_edges) {
      const int num_saddles = RefineSaddleCorners(dark_on_light, cells, &refined->corners_px);
      detection.is_fallback = !is_fitted && num_saddles < kNumCorners;
      num_fallbacks += detection.is_fallback;
    }
    detection.corner_sigma_px = refined->sigma_px;
    for (int c = 0; c < kNumCorners; ++c) {
      detection.corners_in_image_px[c] = refined->corners_px[c].array() + kImageFromOpenCvPx;
    }
    detections.push_back(detection);
  }
  if (num_fallbacks > 0) {
    LogDebug("{} of {} markers: no edge fit, corners from cv::cornerSubPix", num_fallbacks,
             detections.size());
  }
  return detections;
}

}  // namespace velamap
