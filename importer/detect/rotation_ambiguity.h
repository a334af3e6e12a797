// Markers that look the same when turned.
//
// A 3x3-bit dictionary has 120 codes without rotational symmetry; whoever needs more uses some that
// a turn by 180 (or 90) degrees maps onto themselves. The detector then cannot tell which corner is
// the first. The neighbours can: corners are numbered so that the marker stands as they do, which
// gives the same numbers in every frame, however the marker is glued on. Where they cannot, other
// frames may (rotation_evidence.h).

#pragma once

#include <map>
#include <vector>

#include "importer/detect/detection.h"
#include "importer/layout/dictionary.h"
#include "importer/layout/layout.h"

namespace velamap {

// By marker id the quarter turns (of 1, 2, 3) that leave the code as it is; ids with none are not
// in the map.
using CodeSymmetries = std::map<int, std::vector<int>>;
CodeSymmetries FindCodeSymmetries(const Dictionary& dictionary);

// Why a marker is left out whose neighbours leave a doubt; other frames may resolve it
// (rotation_evidence.h).
inline constexpr char kDoubtfulRotation[] =
    "looks the same when turned, neither neighbours nor other frames tell how it stands";

// The marker with its corners numbered from the one `turn` quarter turns further on.
MarkerDetection Turned(const MarkerDetection& marker, int turn);

// Numbers the corners of symmetric markers in a frame. A marker follows the (at most three) nearest
// markers without symmetry, by the graph and, where it names none, in the image: of the possible
// turns it takes the one whose top side runs most like theirs. Where that leaves a doubt (two turns
// fit nearly as well, or no such neighbour is seen) the marker goes to `rejected`. `markers` ascend
// by id.
void ResolveRotations(const CodeSymmetries& symmetries, const AdjacencyGraph& graph,
                      std::vector<MarkerDetection>* markers,
                      std::vector<RejectedDetection>* rejected);

}  // namespace velamap
