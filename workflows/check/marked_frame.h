// The frame of a clip with its markers drawn on it.

#pragma once

#include <opencv2/core.hpp>

#include "importer/detect/detection.h"

namespace velamap {

// Draws outlines and ids: green for markers, red for rejected ones. Enlarges images with small
// markers to make their ids readable. `image` is BGR.
void DrawMarkers(const FrameDetections& detections, cv::Mat* image);

}  // namespace velamap
