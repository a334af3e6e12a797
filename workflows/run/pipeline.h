// The first stages of a reconstruction, from pictures to the seed model; adjustment.h is the next.
// The single commands run one stage each, automatic_reconstructor all.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/report/report_data.h"
#include "importer/database/colmap_database.h"
#include "importer/marker_importer.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/model/model.h"
#include "reconstruct/register_frames.h"

namespace velamap {

struct SeedResult {
  Registration registration;
  Model model;
  std::vector<std::string> image_names;  // of all images in the database, sorted
  // Images that the model does not hold, and those that it does not need.
  std::vector<ReportLeftOut> left_out, not_needed;
  CornerErrors corner_errors;      // from the database
  int num_ids_found = 0;           // different marker ids in the database
  std::optional<ReportClip> clip;  // of a video
};

// The part of `video` that the thesis's search around a central frame with a given number can reach
// (3.4.1), so that the rest is not decoded. All of it without such a number, for the global
// registration, and if the frames count as unordered.
VideoOptions NarrowToReach(const VideoOptions& video, const RegistrationOptions& registration);

// ImportMarkers() with a progress bar, which `what` names.
ImportReport ImportWithProgress(const MarkerImporterOptions& options, const std::string& what);

// ImportWithProgress(); then logs what was found and warns of anything unusual.
ImportReport ImportImages(const MarkerImporterOptions& options);

// Throws InputError, naming both dictionaries, if the layout and the database have different ones.
void CheckLayoutOfDatabase(const ColmapDatabase& database, const std::string& database_path,
                           const Layout& layout);

// Registers the images of a database and makes the seed model; logs the decisions. If the
// database was made without a calibration, its cameras are found first
// (reconstruct/camera_search.h) with the options `adjustment`.
SeedResult RegisterDatabase(const std::string& database_path, const Layout& layout,
                            const RegistrationOptions& options,
                            const MarkerAdjustmentOptions& adjustment = {});

}  // namespace velamap
