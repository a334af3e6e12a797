// Finds the markers of a grey image to a pixel. Only this file and dictionary.h use cv::aruco. A
// marker is found with the same corners in the whole image and in any region that extends
// kSearchReachPx around it, because threshold, contour, quadrilateral and code of a marker do not
// depend on pixels farther away. A second look (second_look.h) needs as much around the outline
// that was found, which may be that of the marker's paper.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/detect/detection_options.h"
#include "importer/detect/marker_quad.h"
#include "importer/layout/dictionary.h"

namespace velamap {

// Half the widest threshold window, plus the band along a border in which OpenCV accepts no corner.
inline constexpr int kSearchReachPx = 6 + 4;

// Searches the whole 8-bit grey image. Ids may occur more than once (duplicates.h); largest markers
// first. Thread-safe.
std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options);

// The same without a second look at outlines whose code cannot be read (second_look.h): for trying
// many dictionaries, because all but one are wrong.
std::vector<MarkerQuad> SearchMarkersAtFirstLook(const cv::Mat& gray, const Dictionary& dictionary,
                                                 int border_bits,
                                                 const ArucoDetectionOptions& options);

// The same at half the resolution, in a quarter of the time: finds large markers, to a few pixels.
std::vector<MarkerQuad> SearchMarkersCoarsely(const cv::Mat& gray, const Dictionary& dictionary,
                                              int border_bits,
                                              const ArucoDetectionOptions& options);

// Searches only within `regions`, which lie in the image. They may overlap; a marker is returned
// once.
std::vector<MarkerQuad> SearchMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                      int border_bits, const ArucoDetectionOptions& options,
                                      const std::vector<cv::Rect>& regions);

// Whether the marker is large enough for a search to accept it.
bool IsLargeEnough(const QuadCorners& corners, const cv::Size& image_size,
                   const ArucoDetectionOptions& options);

// Whether the marker is large enough and far enough from the border for a search to accept it.
bool IsSearchable(const QuadCorners& corners, const cv::Size& image_size,
                  const ArucoDetectionOptions& options);

// A marker may be found at several thresholds, along the outer and the inner contour of its black
// border, or in two regions. Keeps the outer one.
std::vector<MarkerQuad> RemoveNested(std::vector<MarkerQuad> quads);

}  // namespace velamap
