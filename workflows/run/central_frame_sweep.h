// Registers, adjusts and measures one clip around many central frames (thesis Figure 4.24).
//
// What the central frames share is computed once: the detections are read and the markers posed
// once. Each adjustment starts from the result around the previous central frame if that holds half
// of the markers' corners.

#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "exporters/scale/metric_scale.h"
#include "exporters/scale/model_metrics.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/layout/layout.h"
#include "reconstruct/registration/registration_options.h"
#include "reconstruct/thesis/posed_images.h"
#include "workflows/run/adjustment.h"
#include "workflows/run/stage_times.h"

namespace velamap {

struct CentralFrameSweepOptions {
  std::string database_path;
  // "all"; "every:N" for each N-th image, or frame number of a video, from the first on; or names
  // and numbers separated by commas.
  std::string central_frames = "all";
  RegistrationOptions registration;  // of the thesis's method; central_frame is ignored
  AdjustmentOptions adjustment;
  bool warm_start = true;
  ScaleMethod scale_by = ScaleMethod::kAgreeing;  // where the adjustment gives no metres
  // Folder for the metric models and shapes, in a folder for each image, which is named after it
  // and replaced as a whole; empty: none are written.
  std::string models_path;
  std::string log_path;  // COLMAP's output
};

// The result around one central frame. If there is none, `reason` says why, and the metrics are
// empty.
struct SweepRow {
  std::string central_frame;  // frame number of a video, or image name
  std::string image_name;
  int num_images = 0;    // |S| after the adjustment
  bool is_warm = false;  // the adjustment started from the previous row's result
  ShapeMetrics shape;
  ModelMetrics model;
  double wall_s = 0.0;
  double cpu_s = 0.0;
  std::string reason;
};

// The central frames that `choice` names, as frame_idx, ascending and each once. Throws InputError
// for a choice that cannot be read or that names an image that is not there.
std::vector<int> ChooseCentralFrames(const std::string& choice, const PosedImages& posed);

// Calls `done` after each row. `clock` gets the stages "read" and "sweep". Throws InputError and
// ExternalToolError; where the data do not support a result, the row says why.
std::vector<SweepRow> SweepCentralFrames(const CentralFrameSweepOptions& options,
                                         const Layout& layout, StageClock* clock,
                                         const std::function<void(int done, int total)>& done);

// Index of the row with the highest reconstruction ratio (without a layout: the most markers);
// equal rows are compared by their mean area error. -1 if no row has a result.
int BestRow(const std::vector<SweepRow>& rows);

// One row per central frame. Columns: central_frame, image_name, num_images, num_markers,
// reconstruction_ratio, reprojection_error_px_mean, central_reprojection_error_px_mean,
// area_error_mm2_mean, area_error_mm2_max, area_error_percent_mean, start (cold or warm), wall_s,
// cpu_s, reason.
void WriteSweepCsv(const std::vector<SweepRow>& rows, std::ostream& out);

}  // namespace velamap
