#include "importer/refine/marker_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

// A detection and the residual of its pattern; infinite if only its sides, or nothing, could be
// fitted.
struct FittedDetection {
  MarkerDetection marker;
  double rms_gray = std::numeric_limits<double>::infinity();
};

// Returns nothing for a quad that shows no marker.
std::optional<FittedDetection> RefineMarker(const cv::Mat& dark_on_light, const MarkerQuad& found,
                                            const Dictionary& dictionary, int border_bits,
                                            const ArucoDetectionOptions& options,
                                            const ImageFormation& formation,
                                            const std::vector<double>& sides_mm,
                                            const Camera* camera) {
  ReadMarker read{found, {}};
  auto& [quad, refined] = read;
  const bool fits_edges = options.corner_refinement == CornerRefinement::kEdge;
  if (options.corner_refinement == CornerRefinement::kNone) {
    refined = RefinedCorners{found.corners_px};
  } else if (fits_edges) {
    read = RefineAndReadAgain(dark_on_light, found, dictionary, border_bits, formation, sides_mm,
                              camera);
  }
  const cv::Mat cells = MarkerCells(dictionary, quad.marker_id, border_bits);
  const bool is_fitted = refined.has_value();
  // A marker that only an enlarged picture shows must fit as a whole.
  if (fits_edges && !is_fitted && quad.is_second_look) return std::nullopt;
  if (!is_fitted) {
    refined = RefinedCorners{RefineSubpix(dark_on_light, quad.corners_px, cells.rows)};
  }
  FittedDetection detection;
  detection.marker.marker_id = quad.marker_id;
  if (fits_edges) {
    const int num_saddles = RefineSaddleCorners(dark_on_light, cells,
                                                is_fitted ? kSaddleReachOfFit : kSaddleReachOfQuad,
                                                &refined->corners_px);
    detection.marker.is_fallback = !is_fitted && num_saddles < kNumCorners;
  }
  detection.marker.corner_sigma_px = refined->sigma_px;
  if (refined->rms_gray > 0) detection.rms_gray = refined->rms_gray;
  for (int c = 0; c < kNumCorners; ++c) {
    detection.marker.corners_in_image_px[c] = refined->corners_px[c].array() + kImageFromOpenCvPx;
  }
  return detection;
}

bool AreAtSamePlace(const MarkerDetection& a, const MarkerDetection& b) {
  const double side_a_px = QuadMeanSide(a.corners_in_image_px);
  const double side_b_px = QuadMeanSide(b.corners_in_image_px);
  const double half_px = 0.5 * std::max(side_a_px, side_b_px);
  return std::min(side_a_px, side_b_px) > half_px &&
         (CornerMean(a) - CornerMean(b)).norm() < half_px;
}

// The search may read several outlines of one marker, and some of them wrongly. The reading whose
// pattern fits best is kept. Without patterns, there is no telling which of two ids is right.
void AddReading(const FittedDetection& reading, std::vector<FittedDetection>* detections) {
  const auto other =
      std::find_if(detections->begin(), detections->end(), [&](const FittedDetection& detection) {
        const bool differ = detection.marker.marker_id != reading.marker.marker_id;
        const bool has_pattern = std::isfinite(std::min(detection.rms_gray, reading.rms_gray));
        return AreAtSamePlace(detection.marker, reading.marker) && (has_pattern || !differ);
      });
  if (other == detections->end()) {
    detections->push_back(reading);
  } else if (reading.rms_gray < other->rms_gray) {
    *other = reading;
  }
}

}  // namespace

std::vector<MarkerDetection> RefineMarkers(
    const cv::Mat& gray, const std::vector<MarkerQuad>& quads, const Dictionary& dictionary,
    int border_bits, const ArucoDetectionOptions& options, const ImageFormation& formation,
    const std::vector<double>& sides_mm, const Camera* camera) {
  VELAMAP_CHECK(gray.type() == CV_8UC1);
  const cv::Mat dark_on_light = options.inverted ? cv::Mat(~gray) : gray;
  std::vector<FittedDetection> fitted;
  for (const MarkerQuad& quad : quads) {
    const StageTimer timer(ImportStage::kRefine);
    const auto reading = RefineMarker(dark_on_light, quad, dictionary, border_bits, options,
                                      formation, sides_mm, camera);
    if (reading) AddReading(*reading, &fitted);
  }
  std::vector<MarkerDetection> detections;
  for (const FittedDetection& detection : fitted) detections.push_back(detection.marker);
  const auto num_fallbacks = std::count_if(detections.begin(), detections.end(),
                                           [](const auto& marker) { return marker.is_fallback; });
  if (num_fallbacks > 0) {
    LogDebug("{} of {} markers: no edge fit, corners from cv::cornerSubPix", num_fallbacks,
             detections.size());
  }
  return detections;
}

}  // namespace velamap
