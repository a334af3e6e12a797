// What an import refuses: a database that was made in another way, and frames without markers.

#pragma once

#include <string>

#include "importer/database/colmap_database.h"
#include "importer/dictionary_hint.h"
#include "importer/marker_importer.h"

namespace velamap {

// Fewer markers a frame than this are as good as none: false ones turn up in any picture.
inline constexpr double kFewMarkersPerFrame = 0.5;

// Throws InputError if `database` holds images that velamap has not imported, or was made with
// another `detector` (DescribeDetector()) or calibration.
void CheckExisting(const MarkerImporterOptions& options, const std::string& detector,
                   const ColmapDatabase& database);

// Throws DataError if the frames hold no marker, or hardly any while another dictionary finds many.
// What the wrong dictionary or polarity finds are false ids, mostly some that the layout does not
// name; the hint therefore comes before any complaint about ids.
void CheckMarkersFound(const MarkerImporterOptions& options, const std::string& dictionary_name,
                       const ImageSample& sample, const ImportReport& report);

}  // namespace velamap
