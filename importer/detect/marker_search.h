// Where the markers of one grey image are, to a pixel; with dictionary.h the only user of
// cv::aruco. What is found is the same whether the whole image is searched or a region that holds
// the marker with kSearchReachPx around it: threshold, contour, quadrilateral and code of a marker
// depend on nothing farther away.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/detect/detection_options.h"
#include "importer/detect/marker_quad.h"
#include "importer/layout/dictionary.h"

namespace velamap {

// Half the widest threshold window, and the band along a border in which OpenCV takes no corner.
inline constexpr int kSearchReachPx = 6 + 4;

// The whole 8-bit grey image. Ids may occur more than once (duplicates.h); largest markers first.
// Thread-safe.
std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options);

// The same at half the resolution, in a quarter of the time: the large ones, to a few pixels.
std::vector<MarkerQuad> SearchMarkersCoarsely(const cv::Mat& gray, const Dictionary& dictionary,
                                              int border_bits,
                                              const ArucoDetectionOptions& options);

// Only within `regions`, which lie in the image. They may overlap: a marker is handed out once.
std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options,
                                      const std::vector<cv::Rect>& regions);

// Whether a search takes a marker as small as this.
bool IsLargeEnough(const QuadCorners& corners, const cv::Size& image_size,
                   const ArucoDetectionOptions& options);

// Whether a marker there is large enough and far enough from the border for a search to take it.
bool SearchTakes(const QuadCorners& corners, const cv::Size& image_size,
                 const ArucoDetectionOptions& options);

// One marker may be found along the outer and the inner contour of its black border, or in two
// regions. The marker's corners are those of the outer one.
std::vector<MarkerQuad> RemoveNested(std::vector<MarkerQuad> quads);

}  // namespace velamap
