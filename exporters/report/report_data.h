// Collects everything that the report shows in one JSON text, from which the page computes only
// colours and drawings. It is the text of <script id="data"> in report.html. Keys:
//
//   title, version, created, origin (camera, frame rate, duration); options, versions
//   frame                    name, up, forward
//   verdict                  level, reasons (level, text)
//   key_numbers              name, value, meaning, status
//   markers                  id, part, corners, num_images, num_observations, error_px, centre,
//                            length_mm, side_deviation_percent, area_deviation_percent, sigma_mm,
//                            ellipsoid (without errors that markers share),
//                            scale_deviation_percent
//   images                   name, central, centre, frustum, num_markers, marker_ratio,
//                            num_corners, error_mean_px, error_rms_px, error_max_px
//   histograms               first_border, bin_width, counts, num_below, num_above
//   scale                    m_per_unit, spread_percent, sigma_percent, num_markers; scale_audit
//   known_points             rows of the table known_points of metrics.json
//   images_left_out, images_not_needed, markers_left_out    name, reason
//   picture                  name, width_px, height_px, jpeg or problem, points, rejected,
//                            not_detected
//   sections                 rows of the table sections (sail_metrics.h), name, note, profile,
//                            profile_in_shape, design
//   section_notes            what concerns several sections, such as what twist counts from
//   design                   name, num_markers, distance_mm
//   rigs                     rows of the table rigs (sail_metrics.h)
//   surfaces                 part, is_sail, area_m2, volume_m3, distance_mm, sigma_mm, vertices,
//                            triangles
//   surface_notes            notes on the surfaces, and why a part has none

#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "exporters/datum/known_points.h"
#include "exporters/freeform/freeform_shape.h"
#include "exporters/sail/sail_shape.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/model_metrics.h"
#include "exporters/scale/scale_audit.h"
#include "exporters/shape/marker_shape.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/camera/calibration_writer.h"
#include "importer/layout/layout.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ReportLeftOut {
  std::string name;  // of an image, or the id of a marker
  std::string reason;
};

// The frame of the shape and its view directions.
struct ReportFrame {
  std::string name;         // a short description of origin and axes
  Eigen::Vector3d up;       // unit length, shape frame
  Eigen::Vector3d forward;  // viewing direction of the front view, unit length, normal to `up`
};

// The design beside whose sections the measured ones are drawn.
struct ReportDesign {
  std::string name;
  int num_markers = 0;       // over the surface of the design
  double distance_mm = 0.0;  // of these from it after the best fit, rms
  // By section of the sail, in its plane, x along the chord; empty if the design has none.
  std::vector<std::vector<Eigen::Vector2d>> profiles_m = {};
};

// Frame rate and duration of a video, over the frames that show markers.
struct ReportClip {
  double frames_per_s = 0.0;
  double duration_s = 0.0;
};

struct ReportInput {
  const Model& metric_model;  // unit m, world frame = shape frame
  const Layout& layout;
  const MarkerShape& shape;
  const ShapeMetrics& metrics;
  const ModelMetrics& model_metrics;
  const ScaleEstimate& scale;
  const SailShape& sail;
  const FreeformShape& freeform;
  std::string title = {};
  std::string version = {};     // of the program
  std::string created = {};     // date and time; empty for none
  std::string image_path = {};  // folder of the images; empty for a report without picture
  // The view of the central camera by default.
  std::optional<ReportFrame> frame = {};
  const AdjustmentUncertainty* uncertainty = nullptr;  // may be null
  const ScaleAudit* audit = nullptr;                   // may be null
  const KnownPointFit* known_points = nullptr;         // may be null
  std::vector<EstimatedCamera> found_cameras = {};     // from the images; empty if calibrated
  SteadinessVerdict steadiness = {};                   // only steps that are real
  std::vector<std::string> warnings = {};              // of the log
  int num_ids_found = 0;  // different marker ids in the images, in the shape or not; 0: unknown
  std::vector<ReportLeftOut> images_left_out = {};
  std::vector<ReportLeftOut> images_not_needed = {};  // they add little to the others
  // Other missing markers of the layout are added.
  std::vector<ReportLeftOut> markers_left_out = {};
  // The given options and the versions of the libraries, for repeating the run.
  std::vector<std::pair<std::string, std::string>> options = {};
  std::vector<std::pair<std::string, std::string>> versions = {};
  std::optional<ReportDesign> design = {};
  std::optional<ReportClip> clip = {};  // of a video
};

// All markers that are left out, for the report and for what the program prints: those for which
// the caller knows a reason, then other missing markers of the layout.
std::vector<ReportLeftOut> AllMarkersLeftOut(std::vector<ReportLeftOut> known,
                                             const MarkerShape& shape, const ShapeMetrics& metrics);

// The sides of a box with `times` between them: in m to 1 mm, below 1 m in mm to 0.01 mm.
std::string BoxText(const Eigen::Vector3d& sides_m, const std::string& times);

// Returns a JSON object in UTF-8 without line breaks. `<` is escaped, so that the text can be part
// of an HTML script element. Unknown values have no key. Throws DataError for a model without
// images.
std::string ReportJson(const ReportInput& input);

}  // namespace velamap
