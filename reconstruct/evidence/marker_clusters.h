// Clusters of nearby markers, for the markers that are on no row.

#pragma once

#include <vector>

#include "reconstruct/evidence/marker_links.h"

namespace velamap {

// Clusters the markers with the indices `rest` by single linkage. Each of them is in one cluster,
// and the markers of a cluster are in the order of `rest`.
std::vector<MarkerChain> FindClusters(const std::vector<OrientedMarker>& markers,
                                      const MarkerChain& rest);

}  // namespace velamap
