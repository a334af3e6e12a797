// Search and refinement of the markers of one picture in one call.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/detect/marker_search.h"
#include "importer/refine/marker_detector.h"

namespace velamap {

// All markers of `dictionary` in an 8-bit grey image, see RefineMarkers().
inline std::vector<MarkerDetection> DetectMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                                  int border_bits,
                                                  const ArucoDetectionOptions& options) {
  const ImageFormation formation;  // gcc 12 takes the default argument for dangling
  return RefineMarkers(gray, SearchMarkers(gray, dictionary, border_bits, options), dictionary,
                       border_bits, options, formation);
}

}  // namespace velamap
