// The colours of the image at the corners of detected markers.

#pragma once

#include "importer/detect/detection.h"
#include "importer/video/frame_source.h"

namespace velamap {

// Sets the colours of all detections of `frame`, including rejected ones, to the colours of the
// pixels in which their corners lie. Corners outside the image take the nearest pixel.
void AddColors(const Frame& frame, FrameDetections* detections);

}  // namespace velamap
