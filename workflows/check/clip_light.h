// How the markers of a clip are exposed, and how sharp they are.

#pragma once

#include <map>
#include <string>

#include "importer/detect/detection.h"
#include "workflows/check/clip_facts.h"
#include "workflows/check/clip_frames.h"

namespace velamap {

using DetectionsByName = std::map<std::string, const FrameDetections*>;

// Sets the medians of light and blur, and the markers in poor light, from all markers in the frames
// that were read with their pixels. Needs `is_inverted`.
void MeasureLights(const ClipFrames& clip, const DetectionsByName& detections, ClipFacts* facts);

}  // namespace velamap
