// Groups of markers that stand near each other, for those that no row takes. Private to this
// folder.

#pragma once

#include <vector>

#include "reconstruct/evidence/marker_links.h"

namespace velamap {

// Clusters of the markers of `rest` by single linkage: each is in one cluster, in the order of
// `rest`.
std::vector<MarkerChain> FindClusters(const std::vector<StandingMarker>& markers,
                                      const MarkerChain& rest);

}  // namespace velamap
