// Duplicated marker ids within one image (thesis section 3.3, Algorithm 1).

#pragma once

#include <vector>

#include "importer/detect/detection.h"
#include "importer/layout/layout.h"

namespace velamap {

struct ResolvedDetections {
  std::vector<MarkerDetection> markers;     // each id once, ascending
  std::vector<RejectedDetection> rejected;  // with reasons, in order of id then position
};

// If several candidates have the same id, keeps the one whose centre has the smallest mean distance
// (px) to the centres of the topologically nearest markers (three at most) that were found once.
// Without such a neighbour the candidates cannot be told apart, and all are left out.
// The order of `candidates` does not matter.
ResolvedDetections ResolveDuplicates(std::vector<MarkerDetection> candidates,
                                     const AdjacencyGraph& graph);

}  // namespace velamap
