// Markers with a rotational symmetry.
//
// A 3x3-bit dictionary has 120 codes without rotational symmetry; larger sets contain codes that a
// rotation by 180 (or 90) degrees maps onto themselves. The detector cannot tell which of their
// corners is the first. The corners are numbered so that the marker has the orientation of its
// neighbours, which gives the same numbers in every frame, however the marker is glued on. Where
// the neighbours do not decide, other frames may (rotation_evidence.h).

#pragma once

#include <map>
#include <vector>

#include "importer/detect/detection.h"
#include "importer/layout/dictionary.h"
#include "importer/layout/layout.h"

namespace velamap {

// For each marker id the quarter turns (of 1, 2, 3) that map its code onto itself; ids without such
// turns are not in the map.
using CodeSymmetries = std::map<int, std::vector<int>>;
CodeSymmetries FindCodeSymmetries(const Dictionary& dictionary);

// The reason for leaving out a marker whose rotation its neighbours do not decide; other frames may
// resolve it (rotation_evidence.h).
inline constexpr char kDoubtfulRotation[] =
    "looks the same when turned, neither neighbours nor other frames tell how it stands";

// The marker with its corners numbered from corner 1 + `turn` on.
MarkerDetection Turned(const MarkerDetection& marker, int turn);

// Numbers the corners of symmetric markers in a frame. A marker follows the (at most three) nearest
// markers without symmetry, by the graph or, where it names none, in the image: among the possible
// turns it takes the one whose top side has the direction closest to theirs. A marker for which two
// turns fit nearly as well, or which has no such neighbour, goes to `rejected`. `markers` are in
// ascending order of id.
void ResolveRotations(const CodeSymmetries& symmetries, const AdjacencyGraph& graph,
                      std::vector<MarkerDetection>* markers,
                      std::vector<RejectedDetection>* rejected);

}  // namespace velamap
