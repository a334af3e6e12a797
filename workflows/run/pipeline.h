// The stages of a reconstruction. The single commands run one each, automatic_reconstructor all.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "exporters/report/report_data.h"
#include "exporters/shape_exporter.h"
#include "importer/camera/calibration_writer.h"
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
  std::vector<LeftOutImage> left_out;    // images that the model does not hold
  CornerErrors corner_errors;            // from the database
  int num_ids_found = 0;                 // different marker ids in the database
  std::optional<ReportClip> clip;        // of a video
  bool found_cameras = false;            // the database has no calibration
};

// The part of `video` that the thesis's search around a named central frame can reach (3.4.1), so
// that the rest is not decoded. All of it without a named frame, for the global registration, and
// for an unordered one.
VideoOptions NarrowToReach(const VideoOptions& video, const RegistrationOptions& registration);

// ImportMarkers() with a progress bar; logs what was found and what is odd.
ImportReport ImportImages(const MarkerImporterOptions& options);

// Registers the images of a database and makes the seed model; logs the decisions. Where the
// database was made without a calibration, its cameras are found first
// (reconstruct/camera_search.h) with the options `adjustment`.
SeedResult RegisterDatabase(const std::string& database_path, const Layout& layout,
                            const RegistrationOptions& options,
                            const MarkerAdjustmentOptions& adjustment = {});

enum class AdjustmentBackend {
  kColmap,   // COLMAP's own program
  kMarkers,  // ours, which knows the size of the markers
  kBoth,     // COLMAP's, then ours
};

struct AdjustmentOptions {
  AdjustmentBackend backend = AdjustmentBackend::kBoth;
  BundleAdjustmentOptions colmap;
  MarkerAdjustmentOptions markers;

  bool UsesColmap() const { return backend != AdjustmentBackend::kMarkers; }
  bool UsesMarkers() const { return backend != AdjustmentBackend::kColmap; }
  // Copies the parameters that both adjustments have to `markers`. Throws InputError that names the
  // option for a bad one.
  void Complete(int num_threads);
};

struct AdjustmentResult {
  Statistics error_before_px;
  Statistics error_after_px;
  int num_removed = 0;                               // observations
  std::optional<AdjustmentUncertainty> uncertainty;  // of the marker-aware adjustment
  std::map<CameraId, EstimatedCamera> cameras;       // found from the pictures; else none
};

// Throws ExternalToolError if COLMAP's program cannot be started. Called first, so that nobody
// waits for the detection in vain.
void CheckColmap(const std::string& colmap_path);

// Adjusts the model and logs how it went. Warns where the images were not taken by one steady
// camera; with find_camera that is a DataError, unless only the principal point wanders. The
// marker-aware adjustment needs `layout` and takes `corner_errors`; `log_path` gets COLMAP's
// output.
AdjustmentResult AdjustModel(const AdjustmentOptions& options, const Layout& layout,
                             const CornerErrors& corner_errors, const std::string& log_path,
                             Model* model);

// Warns of lines and heights that have no section, with the reason.
void WarnOfMissingSections(const SectionReport& sections);

// Writes the model, and beside it the uncertainty if there is one.
void WriteAdjustedModel(const Model& model, const AdjustmentResult& result,
                        const std::string& path);

}  // namespace velamap
