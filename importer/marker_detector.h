// Finds markers in one grey image; with dictionary.h the only user of cv::aruco.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/detection.h"
#include "importer/dictionary.h"
#include "importer/options.h"

namespace velamap {

// Detects all markers of `dictionary` in an 8-bit grey image. Corners are in the image frame (px);
// the half pixel between OpenCV's pixel centres and COLMAP's is added here and nowhere else. Edge
// refinement gives each corner its sigma, or marks the detection as a fallback.
// Ids may occur more than once (duplicates.h). Thread-safe; colours are left zero.
std::vector<MarkerDetection> DetectMarkers(const cv::Mat& gray, const Dictionary& dictionary,
                                           int border_bits, const ArucoDetectionOptions& options);

}  // namespace velamap
