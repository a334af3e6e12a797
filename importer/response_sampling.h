// What camera and print do to edges, from a few frames of the source: the first step of an import.

#pragma once

#include "importer/marker_importer.h"
#include "importer/refine/response_estimation.h"
#include "importer/track/frame_detector.h"

namespace velamap {

// Estimates the response from markers of frames spread over the source (of a video, over its
// beginning). Nothing where too few markers are large enough to tell.
std::optional<ResponseEstimate> EstimateResponseOfSource(const MarkerImporterOptions& options,
                                                         const FrameDetector& detector);

}  // namespace velamap
