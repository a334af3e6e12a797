#include "importer/detect/marker_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/detect/interpolate.h"

namespace velamap {
namespace {

constexpr int kMinBorderDistancePx = 3;  // of a corner

// For a region of an image; the smallest perimeter is relative to the size of the image.
cv::Ptr<cv::aruco::DetectorParameters> MakeParameters(int border_bits,
                                                      const ArucoDetectionOptions& options,
                                                      int image_size_px, int region_size_px) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  // Windows of 5 and 13 px find as many markers as OpenCV's 3, 13 and 23 px, and more small ones
  // among other black squares, in three quarters of the time (measured on photographs of markers of
  // 34 to 110 px and at 4K on 12 to 500 px, sharp and blurred).
  parameters->adaptiveThreshWinSizeMin = 5;
  parameters->adaptiveThreshWinSizeMax = 13;
  parameters->adaptiveThreshWinSizeStep = 8;
  // Every outline is decoded. OpenCV keeps the largest of close outlines before it reads their
  // codes: where a narrow margin lies on a dark ground, that is the edge of the paper, which gives
  // no code.
  parameters->minMarkerDistanceRate = 0.0;
  // Reads only the middle of each cell, because blur and an outline that is a pixel off spoil its
  // rim. This finds twice as many markers with cells of 4 px (measured on rendered photographs).
  parameters->perspectiveRemoveIgnoredMarginPerCell = 0.3;
  parameters->minDistanceToBorder = kMinBorderDistancePx;
  parameters->markerBorderBits = border_bits;
  parameters->minMarkerPerimeterRate = options.min_marker_perimeter_rate;
  parameters->errorCorrectionRate = options.error_correction_rate;
  if (region_size_px != image_size_px) {
    // OpenCV truncates the product of rate and size to whole pixels; half a pixel more makes it the
    // number of the whole image.
    const double perimeter_px = std::floor(options.min_marker_perimeter_rate * image_size_px);
    parameters->minMarkerPerimeterRate = (perimeter_px + 0.5) / region_size_px;
  }
  return parameters;
}

// The pixels within `reach_px` of a marker.
cv::Rect Surroundings(const QuadCorners& corners, int reach_px) {
  const auto [min, max] = BoundingBox(corners);
  const cv::Point top_left(static_cast<int>(min.x()) - reach_px,
                           static_cast<int>(min.y()) - reach_px);
  const cv::Point bottom_right(static_cast<int>(max.x()) + reach_px + 1,
                               static_cast<int>(max.y()) + reach_px + 1);
  return {top_left, bottom_right};
}

bool Contains(const cv::Rect& outer, const cv::Rect& inner) { return (outer & inner) == inner; }

// Whether the outline is darker on its inside, as that of a marker is. The edge of its paper on a
// darker ground is not, but may give the same code.
bool IsDarkInside(const cv::Mat& gray, const std::vector<cv::Point2f>& outline_px) {
  constexpr int kNumSamples = 8;  // of a side
  constexpr float kOffsetPx = 1.5F;
  const cv::Point2f center = (outline_px[0] + outline_px[1] + outline_px[2] + outline_px[3]) / 4;
  int outside_minus_inside = 0;
  for (int c = 0; c < kNumCorners; ++c) {
    const cv::Point2f side = outline_px[(c + 1) % kNumCorners] - outline_px[c];
    for (int i = 0; i < kNumSamples; ++i) {
      const cv::Point2f on_side = outline_px[c] + (i + 0.5F) / kNumSamples * side;
      const cv::Point2f inwards = center - on_side;
      const cv::Point2f step = inwards * (kOffsetPx / std::max(1.0, cv::norm(inwards)));
      outside_minus_inside += NearestGray(gray, on_side - step) - NearestGray(gray, on_side + step);
    }
  }
  return outside_minus_inside > 0;
}

void SearchRegion(const cv::Mat& gray, const cv::Rect& region, const Dictionary& dictionary,
                  int border_bits, const ArucoDetectionOptions& options,
                  std::vector<MarkerQuad>* quads) {
  cv::Mat dark_on_light = gray(region);
  if (options.inverted) {
    cv::Mat inverted;  // a new one, so that the image of the caller does not change
    cv::bitwise_not(dark_on_light, inverted);
    dark_on_light = inverted;
  }
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(dark_on_light, dictionary.aruco, corners, ids,
                           MakeParameters(border_bits, options, std::max(gray.cols, gray.rows),
                                          std::max(region.width, region.height)));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!IsDarkInside(dark_on_light, corners[i])) continue;
    MarkerQuad quad;
    quad.marker_id = ids[i];
    for (int c = 0; c < kNumCorners; ++c)
      quad.corners_px[c] = {corners[i][c].x + region.x, corners[i][c].y + region.y};
    quads->push_back(quad);
  }
}

}  // namespace

bool IsLargeEnough(const QuadCorners& corners, const cv::Size& image_size,
                   const ArucoDetectionOptions& options) {
  return kNumCorners * QuadMeanSide(corners) >
         options.min_marker_perimeter_rate * std::max(image_size.width, image_size.height);
}

bool IsSearchable(const QuadCorners& corners, const cv::Size& image_size,
                  const ArucoDetectionOptions& options) {
  const double min = kMinBorderDistancePx;
  const double max_x = image_size.width - 1 - min, max_y = image_size.height - 1 - min;
  return IsLargeEnough(corners, image_size, options) &&
         std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
           return corner.x() > min && corner.y() > min && corner.x() < max_x && corner.y() < max_y;
         });
}

std::vector<MarkerQuad> RemoveNested(std::vector<MarkerQuad> quads) {
  std::stable_sort(quads.begin(), quads.end(), [](const MarkerQuad& a, const MarkerQuad& b) {
    return QuadArea(a.corners_px) > QuadArea(b.corners_px);
  });
  std::vector<MarkerQuad> kept;
  for (const MarkerQuad& quad : quads) {
    const bool nested = std::any_of(kept.begin(), kept.end(), [&](const MarkerQuad& outer) {
      const double distance = (QuadCenter(outer.corners_px) - QuadCenter(quad.corners_px)).norm();
      return outer.marker_id == quad.marker_id && distance < 0.5 * QuadMeanSide(outer.corners_px);
    });
    if (!nested) kept.push_back(quad);
  }
  return kept;
}

std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options) {
  return SearchMarkers(gray, dictionary, border_bits, options, {{0, 0, gray.cols, gray.rows}});
}

std::vector<MarkerQuad> SearchMarkersCoarsely(const cv::Mat& gray, const Dictionary& dictionary,
                                              int border_bits,
                                              const ArucoDetectionOptions& options) {
  cv::Mat half;
  cv::resize(gray, half, {}, 0.5, 0.5, cv::INTER_AREA);
  std::vector<MarkerQuad> quads = SearchMarkers(half, dictionary, border_bits, options);
  for (MarkerQuad& quad : quads) {
    for (Eigen::Vector2d& corner : quad.corners_px) {
      corner = 2.0 * corner + Eigen::Vector2d(0.5, 0.5);  // of pixel centres
    }
  }
  return quads;
}

std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options,
                                      const std::vector<cv::Rect>& regions) {
  VELAMAP_CHECK(gray.type() == CV_8UC1);
  const cv::Rect image(0, 0, gray.cols, gray.rows);
  std::vector<MarkerQuad> quads;
  for (const cv::Rect& region : regions) {
    std::vector<MarkerQuad> found;
    SearchRegion(gray, region, dictionary, border_bits, options, &found);
    for (const MarkerQuad& quad : found) {
      if (Contains(region, Surroundings(quad.corners_px, kSearchReachPx) & image)) {
        quads.push_back(quad);
      } else {
        // The border cuts into the pixels that the search depends on.
        SearchRegion(gray, Surroundings(quad.corners_px, 2 * kSearchReachPx) & image, dictionary,
                     border_bits, options, &quads);
      }
    }
  }
  return RemoveNested(std::move(quads));
}

}  // namespace velamap
