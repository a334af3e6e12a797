// Registration, adjustment and the thesis's metrics around many central frames of one clip (thesis
// Figure 4.24), without repeating what they share.
//
// The detections are read once and every marker is posed once. Each adjustment starts from the
// result around the central frame before, where that holds half of the markers' corners.

#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "exporters/scale/model_metrics.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/layout/layout.h"
#include "reconstruct/registration/registration_options.h"
#include "reconstruct/thesis/posed_images.h"
#include "workflows/run/pipeline.h"
#include "workflows/run/stage_times.h"

namespace velamap {

struct CentralFrameSweepOptions {
  std::string database_path;
  // "all", "every:N" (each N-th image, or number of a video's frames, from the first on), or a list
  // with commas of names or numbers.
  std::string central_frames = "all";
  RegistrationOptions registration;  // the thesis's method; central_frame is set for each
  AdjustmentOptions adjustment;
  bool warm_start = true;
  std::string models_path;  // folder for a metric model and shape.csv each; empty: not written
  std::string log_path;     // COLMAP's output
};

// One central frame. Without a result `reason` says why, and the metrics are empty.
struct SweepRow {
  std::string central_frame;  // number in the video, or name of the image
  std::string image_name;
  int num_images = 0;    // |S| after the adjustment
  bool is_warm = false;  // the adjustment began at the neighbour's
  ShapeMetrics shape;
  ModelMetrics model;
  double wall_s = 0.0;
  double cpu_s = 0.0;
  std::string reason;
};

// The central frames that `choice` names, as frame_idx, ascending and each once. Throws InputError
// for a choice that cannot be read and an image that is not there.
std::vector<int> ChooseCentralFrames(const std::string& choice, const PosedImages& posed);

// Calls `done` after each row. `clock` gets the stages "read" and "sweep". Throws InputError and
// ExternalToolError; what the data do not support is a row with a reason.
std::vector<SweepRow> SweepCentralFrames(const CentralFrameSweepOptions& options,
                                         const Layout& layout, StageClock* clock,
                                         const std::function<void(int done, int total)>& done);

// Index of the row with the highest reconstruction ratio (without a layout: most markers), of equal
// ones that with the smallest mean area error; -1: no row has a result.
int BestRow(const std::vector<SweepRow>& rows);

// One row a central frame. Columns: central_frame, image_name, num_images, num_markers,
// reconstruction_ratio, reprojection_error_px_mean, central_reprojection_error_px_mean,
// area_error_mm2_mean, area_error_mm2_max, area_error_percent_mean, start (cold or warm), wall_s,
// cpu_s, reason.
void WriteSweepCsv(const std::vector<SweepRow>& rows, std::ostream& out);

}  // namespace velamap
