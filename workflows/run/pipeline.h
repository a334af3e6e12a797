// The stages of a reconstruction. The single commands run one each, automatic_reconstructor all.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/shape_exporter.h"
#include "importer/marker_importer.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/model.h"
#include "reconstruct/register_frames.h"

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
  CornerSigmas corner_sigmas;            // as the database has them
};

// The part of a video that the thesis's search around a named central frame can reach (3.4.1), so
// that nothing else is decoded; all that `video` asks for where no frame number is named, or where
// the registration is the global one.
VideoOptions NarrowToReach(const VideoOptions& video, const RegistrationOptions& registration);

// ImportMarkers() with progress, and a log line on what is odd.
ImportReport ImportImages(const MarkerImporterOptions& options);

// Registers the images of a database and makes the seed model; logs what was decided.
SeedResult RegisterDatabase(const std::string& database_path, const Layout& layout,
                            const RegistrationOptions& options);

// A file beside a model folder, where the single commands put tables and logs: for sparse/seed/ it
// is sparse/NAME.
std::string BesideFolder(const std::string& folder, const std::string& name);

// Which adjustments run, in this order, and how.
struct AdjustmentOptions {
  std::string backend = "both";  // colmap, markers, or both: COLMAP's first, then ours
  // Of both backends where a parameter makes sense for both.
  BundleAdjustmentOptions colmap;
  MarkerAdjustmentOptions markers;

  bool UsesColmap() const { return backend != "markers"; }
  bool UsesMarkers() const { return backend != "colmap"; }
  // Hands the common parameters on to `markers` and throws InputError that names the wrong option.
  void Complete(int num_threads);
};

struct AdjustmentResult {
  Statistics error_before_px;
  Statistics error_after_px;
  int num_removed = 0;                               // observations
  std::optional<AdjustmentUncertainty> uncertainty;  // where the model is metric: after `markers`
};

// Throws ExternalToolError if COLMAP's program cannot be started: better before an hour of
// detection than after it.
void CheckColmap(const std::string& colmap_path);

// Adjusts the model; logs the course. `layout` and `corner_sigmas` are what `markers` knows of the
// markers; `log_path` gets COLMAP's output.
AdjustmentResult AdjustModel(const AdjustmentOptions& options, const Layout& layout,
                             const CornerSigmas& corner_sigmas, const std::string& log_path,
                             Model* model);

// The model, and beside it the uncertainty where there is one.
void WriteAdjustedModel(const Model& model, const AdjustmentResult& result,
                        const std::string& path);

}  // namespace velamap
