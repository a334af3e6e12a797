// The adjustment of a model by COLMAP's program, by the marker-aware adjustment, or by both.

#pragma once

#include <map>
#include <optional>
#include <string>

#include "importer/camera/calibration_writer.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/colmap/bundle_adjustment.h"
#include "reconstruct/model/model.h"

namespace velamap {

enum class AdjustmentBackend {
  kColmap,   // COLMAP's own program
  kMarkers,  // velamap's, which knows the size of the markers
  kBoth,     // COLMAP's, then velamap's
};

struct AdjustmentOptions {
  AdjustmentBackend backend = AdjustmentBackend::kBoth;
  BundleAdjustmentOptions colmap;
  MarkerAdjustmentOptions markers;

  bool UsesColmap() const { return backend != AdjustmentBackend::kMarkers; }
  bool UsesMarkers() const { return backend != AdjustmentBackend::kColmap; }
  // Copies the options that both adjustments share from `colmap` to `markers`, and checks both.
  // Throws InputError that names a bad option.
  void Complete(int num_threads);
};

struct AdjustmentResult {
  Statistics error_before_px;
  Statistics error_after_px;
  int num_removed = 0;                               // observations
  std::optional<AdjustmentUncertainty> uncertainty;  // of the marker-aware adjustment
  std::map<CameraId, EstimatedCamera> cameras;       // found from the pictures; else none
  SteadinessVerdict steadiness;                      // of CheckSteadiness()
};

// Throws ExternalToolError if COLMAP's program cannot be started. To be called first, so that this
// error comes before the long detection.
void CheckColmap(const std::string& colmap_path);

// Adjusts the model and logs how it went. Warns where the images were not taken by one steady
// camera; with find_camera that is a DataError, unless only the principal point wanders. The
// marker-aware adjustment needs `layout` and takes `corner_errors`; `log_path` gets COLMAP's
// output.
AdjustmentResult AdjustModel(const AdjustmentOptions& options, const Layout& layout,
                             const CornerErrors& corner_errors, const std::string& log_path,
                             Model* model);

// Writes the model, and beside it the uncertainty if there is one.
void WriteAdjustedModel(const Model& model, const AdjustmentResult& result,
                        const std::string& path);

}  // namespace velamap
