// What other frames say about markers that look the same when turned (rotation_ambiguity.h).
//
// Two markers on one surface keep their relation: seen from the other marker, a marker's place and
// the direction of its top side stay nearly what they are from any view. Where a frame's own
// neighbours leave a doubt, the relations learned in frames without one decide.

#pragma once

#include <cstddef>
#include <vector>

#include "importer/detect/detection.h"
#include "importer/detect/rotation_ambiguity.h"
#include "importer/layout/layout.h"

namespace velamap {

// Numbers the corners of symmetric markers in all frames: first each frame for itself
// (ResolveRotations(), done anew), then in rounds by what the frames say together, in which
// a symmetric marker counts as soon as it is resolved. A relation counts when at least three frames
// show it and nine in ten of them agree. A marker is turned as every relation with a marker in its
// frame wants it; it stays rejected if there is none, or if two disagree.
//
// The order of the frames changes nothing, nor does an earlier call on some of them. Returns the
// indices of the frames whose detections have changed, ascending.
std::vector<std::size_t> ResolveRotationsAcrossFrames(const CodeSymmetries& symmetries,
                                                      const AdjacencyGraph& graph,
                                                      std::vector<FrameDetections>* frames);

}  // namespace velamap
