// Evidence from other frames for markers with a rotational symmetry (rotation_ambiguity.h).
//
// Two markers on one surface keep their relation: in the frame of the other marker, the place of a
// marker and the direction of its top side are nearly the same from any view. Where the neighbours
// in a frame do not decide, the relations learned in other frames do.

#pragma once

#include <cstddef>
#include <vector>

#include "importer/detect/detection.h"
#include "importer/layout/layout.h"
#include "importer/rotation/rotation_ambiguity.h"

namespace velamap {

// Numbers the corners of symmetric markers in all frames: first in each frame alone
// (ResolveRotations(), repeated from the start), then in rounds by the relations of all frames, in
// which a symmetric marker counts as soon as it is resolved. A relation counts when at least three
// frames show it and nine in ten of them agree. A marker takes the turn on which all relations with
// the markers of its frame agree; without a relation, or if two disagree, it stays rejected.
//
// The result depends neither on the order of the frames nor on an earlier call on some of them.
// Returns the indices of the frames whose detections have changed, ascending.
std::vector<std::size_t> ResolveRotationsAcrossFrames(const CodeSymmetries& symmetries,
                                                      const AdjacencyGraph& graph,
                                                      std::vector<FrameDetections>* frames);

}  // namespace velamap
