// Refines the corners of the markers that were found in one grey image (marker_search.h) to a
// fraction of a pixel.

#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/detection.h"
#include "importer/detect/detection_options.h"
#include "importer/detect/marker_quad.h"
#include "importer/layout/dictionary.h"
#include "importer/pattern/image_formation.h"

namespace velamap {

// Refines the corners of markers that SearchMarkers() has found in an 8-bit grey image, in their
// order, and reads the codes of fitted ones again (read_again.h). Corners are in the image frame
// (px); the half pixel between OpenCV's pixel centres and COLMAP's is already added. Edge
// refinement sets the sigma of each corner, or marks the detection as a fallback. Of several
// readings at one place, the one that fits best is kept. Leaves out markers that only a second look
// has found and that cannot be fitted. Ids may occur more than once (duplicates.h). Thread-safe;
// colours are left zero. `sides_mm`, by id, are the sides of the printed squares; where one is
// missing or 0, it is 100 mm. The camera, which may be null, says how its lens bends the markers.
std::vector<MarkerDetection> RefineMarkers(const cv::Mat& gray,
                                           const std::vector<MarkerQuad>& quads,
                                           const Dictionary& dictionary, int border_bits,
                                           const ArucoDetectionOptions& options,
                                           const ImageFormation& formation = ImageFormation(),
                                           const std::vector<double>& sides_mm = {},
                                           const Camera* camera = nullptr);

}  // namespace velamap
