// How an import continues where an earlier one of the same video ended or was interrupted.

#pragma once

#include <string>
#include <vector>

#include "importer/database/colmap_database.h"
#include "importer/database/tracking_table.h"
#include "importer/marker_importer.h"

namespace velamap {

// The tracking that the database holds. For photographs, and if the earlier import searched other
// frames of the video, the state before the first frame.
TrackingState ContinuedTracking(const MarkerImporterOptions& options,
                                const ColmapDatabase& database);

// Adds the names of all frames that have been searched, because the database has no row for those
// without markers.
std::vector<std::string> WithSearchedFrames(std::vector<std::string> known_names,
                                            const TrackingState& tracking);

}  // namespace velamap
