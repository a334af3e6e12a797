#include "importer/marker_detector.h"

#include <algorithm>
#include <cmath>

#include <spdlog/spdlog.h>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/corner_refinement.h"
#include "importer/saddle_corners.h"
#include "importer/stage_timer.h"

namespace velamap {
namespace {

// OpenCV puts (0,0) at the first pixel's centre, COLMAP at the image's corner.
const Eigen::Vector2d kImageFromOpenCvPx(0.5, 0.5);

using Quad = std::array<Eigen::Vector2d, kNumCorners>;  // OpenCV's pixel frame, px

struct QuadWithId {
  int marker_id = 0;
  Quad corners_px;
};

cv::Ptr<cv::aruco::DetectorParameters> MakeParameters(int border_bits,
                                                      const ArucoDetectionOptions& options) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  // Windows of 5 and 13 px. Measured on photographs of 34 to 110 px markers and at 4K on 12 to 500
  // px ones, sharp and blurred: no fewer markers than with OpenCV's 3, 13 and 23 px, small ones
  // among other black squares more, in three quarters of the time.
  parameters->adaptiveThreshWinSizeMin = 5;
  parameters->adaptiveThreshWinSizeMax = 13;
  parameters->adaptiveThreshWinSizeStep = 8;
  parameters->markerBorderBits = border_bits;
  parameters->minMarkerPerimeterRate = options.min_marker_perimeter_rate;
  parameters->errorCorrectionRate = options.error_correction_rate;
  return parameters;
}

double Area(const Quad& quad) {
  double doubled_area = 0.0;
  for (int i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector2d& a = quad[i];
    const Eigen::Vector2d& b = quad[(i + 1) % kNumCorners];
    doubled_area += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(doubled_area);
}

double MeanSide(const Quad& quad) {
  double perimeter = 0.0;
  for (int i = 0; i < kNumCorners; ++i) perimeter += (quad[(i + 1) % kNumCorners] - quad[i]).norm();
  return perimeter / kNumCorners;
}

Eigen::Vector2d Center(const Quad& quad) { return 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]); }

// One marker may be found along the outer and the inner contour of its black border. The marker's
// corners are those of the outer one.
std::vector<QuadWithId> RemoveNested(std::vector<QuadWithId> quads) {
  std::stable_sort(quads.begin(), quads.end(), [](const QuadWithId& a, const QuadWithId& b) {
    return Area(a.corners_px) > Area(b.corners_px);
  });
  std::vector<QuadWithId> kept;
  for (const QuadWithId& quad : quads) {
    const bool nested = std::any_of(kept.begin(), kept.end(), [&](const QuadWithId& outer) {
      const double distance = (Center(outer.corners_px) - Center(quad.corners_px)).norm();
      return outer.marker_id == quad.marker_id && distance < 0.5 * MeanSide(outer.corners_px);
    });
    if (!nested) kept.push_back(quad);
  }
  return kept;
}

std::vector<QuadWithId> FindQuads(const cv::Mat& gray, const Dictionary& dictionary,
                                  int border_bits, const ArucoDetectionOptions& options) {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(gray, dictionary.aruco, corners, ids,
                           MakeParameters(border_bits, options));
  std::vector<QuadWithId> quads(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    quads[i].marker_id = ids[i];
    for (int c = 0; c < kNumCorners; ++c)
      quads[i].corners_px[c] = {corners[i][c].x, corners[i][c].y};
  }
  return RemoveNested(std::move(quads));
}

// The search window ends well within the cell that meets its neighbours at the corner.
Quad RefineSubpix(const cv::Mat& gray, const Quad& quad, int num_cells) {
  const double cell_px = MeanSide(quad) / num_cells;
  const int half_window = std::clamp(static_cast<int>(std::lround(0.4 * cell_px)), 1, 5);
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& corner : quad) {
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  }
  cv::cornerSubPix(gray, points, cv::Size(half_window, half_window), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 0.01));
  Quad refined;
  for (int c = 0; c < kNumCorners; ++c) refined[c] = {points[c].x, points[c].y};
  return refined;
}

}  // namespace

std::vector<MarkerDetection> DetectMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                           int border_bits, const ArucoDetectionOptions& options) {
  VELAMAP_CHECK(gray.type() == CV_8UC1);
  cv::Mat dark_on_light;  // a fresh one, so that the caller's picture stays
  if (options.inverted) {
    cv::bitwise_not(gray, dark_on_light);
  } else {
    dark_on_light = gray;
  }
  const int num_cells = dictionary.aruco->markerSize + 2 * border_bits;
  std::vector<MarkerDetection> detections;
  int num_fallbacks = 0;
  for (const QuadWithId& quad : FindQuads(dark_on_light, dictionary, border_bits, options)) {
    const StageTimer timer(ImportStage::kRefine);
    std::optional<RefinedCorners> refined;
    MarkerDetection detection;
    detection.marker_id = quad.marker_id;
    if (options.corner_refinement == CornerRefinement::kNone) {
      refined = RefinedCorners{quad.corners_px, {}};
    } else if (options.corner_refinement == CornerRefinement::kEdge) {
      cv::Mat cells;  // one pixel a cell
      cv::aruco::drawMarker(dictionary.aruco, quad.marker_id, num_cells, cells, border_bits);
      refined = RefineCorners(dark_on_light, quad.corners_px, cells);
      detection.is_fallback = !refined;
      num_fallbacks += !refined;
    }
    if (!refined) refined = {RefineSubpix(dark_on_light, quad.corners_px, num_cells), {}};
    if (options.corner_refinement == CornerRefinement::kEdge) {
      RefineSaddleCorners(dark_on_light, num_cells, &refined->corners_px);
    }
    detection.corner_sigma_px = refined->sigma_px;
    for (int c = 0; c < kNumCorners; ++c) {
      detection.corners_in_image_px[c] = refined->corners_px[c] + kImageFromOpenCvPx;
    }
    detections.push_back(detection);
  }
  if (num_fallbacks > 0) {
    spdlog::debug("{} of {} markers: no edge fit, corners from cv::cornerSubPix", num_fallbacks,
                  detections.size());
  }
  return detections;
}

}  // namespace velamap
