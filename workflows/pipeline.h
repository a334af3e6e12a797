// The stages of a reconstruction. The single commands run one each, automatic_reconstructor all.

#pragma once

#include <string>
#include <vector>

#include "exporters/shape_exporter.h"
#include "importer/marker_importer.h"
#include "reconstruct/bundle_adjustment.h"
#include "reconstruct/model.h"
#include "reconstruct/registration.h"

namespace velamap {

struct LeftOutImage {
  std::string image_name;
  std::string reason;
};

struct SeedResult {
  Registration registration;
  Model model;
  std::vector<std::string> image_names;  // of all images in the database, sorted
  std::vector<LeftOutImage> left_out;    // those that the model does not hold
};

// The part of a video that the search around a named central frame can reach (thesis 3.4.1), so that
// nothing else is decoded; all that `video` asks for where no frame number is named.
VideoOptions NarrowToReach(const VideoOptions& video, const RegistrationOptions& registration);

// ImportMarkers() with progress, and a log line on what is odd.
ImportReport ImportImages(const MarkerImporterOptions& options);

// Registers the images of a database and makes the seed model; logs what was decided.
SeedResult RegisterDatabase(const std::string& database_path, const Layout& layout,
                            const RegistrationOptions& options);

// A file beside a model folder, where the single commands put tables and logs: for sparse/seed/ it
// is sparse/NAME.
std::string BesideFolder(const std::string& folder, const std::string& name);

// Throws InputError for a backend that does not exist.
void CheckBackend(const std::string& backend);

// Throws ExternalToolError if COLMAP's program cannot be started: better before an hour of
// detection than after it.
void CheckColmap(const std::string& colmap_path);

// Adjusts the model with COLMAP; logs the course.
BundleAdjustmentSummary AdjustModel(const BundleAdjustmentOptions& options,
                                    const std::string& log_path, Model* model);

}  // namespace velamap
