#include "workflows/check/clip_precision.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>

#include "exporters/shape/shape_sigma.h"
#include "importer/base/error.h"
#include "importer/database/colmap_database.h"
#include "importer/geometry/directions.h"
#include "importer/geometry/units.h"
#include "reconstruct/adjust/camera_adjustment.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/camera/camera_steadiness.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"
#include "workflows/run/camera_checks.h"

namespace velamap {
namespace {

// By image name: the unit vector from the middle of all points to the camera.
std::map<std::string, Eigen::Vector3d> DirectionsToCameras(const Model& model) {
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  for (const auto& [point3D_id, point] : model.points3D) middle_m += point.x_in_world;
  middle_m /= static_cast<double>(model.points3D.size());
  std::map<std::string, Eigen::Vector3d> directions;
  for (const ModelImage& image : model.images) {
    directions[image.name] = (Inverse(image.cam_from_world).translation - middle_m).normalized();
  }
  return directions;
}

double Parallax_deg(const std::map<std::string, Eigen::Vector3d>& directions) {
  std::vector<Eigen::Vector3d> all;
  for (const auto& [name, direction] : directions) all.push_back(direction);
  return kDegPerRad * LargestAngle(all);
}

ClipPrecision PrecisionOf(const Model& model, const MarkerAdjustmentSummary& summary) {
  ClipPrecision precision;
  precision.num_images = static_cast<int>(model.images.size());
  const std::map<int, double> sigmas_mm = CenterSigmas_mm(summary.uncertainty.points);
  if (sigmas_mm.empty()) throw DataError("no marker is left with all four corners");
  precision.num_markers = static_cast<int>(sigmas_mm.size());
  precision.marker_sigma_mm = MedianSigma(sigmas_mm);
  precision.scale_sigma = summary.uncertainty.relative_scale_sigma;
  precision.directions = DirectionsToCameras(model);
  precision.parallax_deg = Parallax_deg(precision.directions);
  precision.steadiness = JudgeSteadiness(model);
  precision.calibration = summary.uncertainty.calibration;
  for (const auto& [camera_id, camera] : summary.cameras) precision.found_cameras.push_back(camera);
  precision.warnings = summary.warnings;
  return precision;
}

// Images and markers that contradict the others.
void AddDoubts(const Registration& registration, ClipPrecision* precision) {
  if (std::string doubt = CameraDoubt(registration); !doubt.empty()) {
    precision->warnings.push_back(std::move(doubt));
  }
  for (const RegisteredFrame& frame : registration.frames) {
    if (frame.num_contradicting > 0) precision->contradicting_images.insert(frame.image_name);
  }
  for (const DroppedMarker& marker : registration.dropped_markers) {
    if (!marker.is_false) continue;
    precision->markers_left_out.push_back(
        fmt::format("marker {}: {}", marker.marker_id, marker.reason));
  }
}

}  // namespace

double LargestAngle(const std::vector<Eigen::Vector3d>& directions) {
  double largest = 0.0;
  for (const Eigen::Vector3d& a : directions) {
    for (const Eigen::Vector3d& b : directions) largest = std::max(largest, AngleBetween(a, b));
  }
  return largest;
}

ClipPrecision MeasurePrecision(const std::string& database_path, const Layout& layout,
                               int num_threads) {
  const ColmapDatabase database(database_path, ColmapDatabase::Mode::kReadOnly);
  std::vector<DatabaseImage> images = database.ReadImages();
  std::map<CameraId, Camera> cameras = database.ReadCameras();
  const CornerErrors corner_errors = CornerErrorsOf(images, database.ReadFormation());
  RegistrationOptions registration_options;
  MarkerAdjustmentOptions adjustment_options;
  registration_options.num_threads = adjustment_options.num_threads = num_threads;
  registration_options.has_calibration = database.HasCalibration();
  adjustment_options.find_camera = !registration_options.has_calibration;
  if (adjustment_options.find_camera) {
    // Few frames, because the check of a clip must not take longer than its reconstruction.
    RegistrationOptions search = registration_options;
    search.global.max_num_frames = 16;
    cameras =
        FindUnknownCameras(cameras, layout, corner_errors, search, adjustment_options, &images);
  }
  const Registration registration = RegisterFrames(images, cameras, layout, registration_options);
  const Model seed = MakeSeedModel(registration, images, cameras);
  Model model = seed;
  const MarkerAdjustmentSummary summary =
      AdjustWithMarkers(adjustment_options, layout, corner_errors, &model);
  ClipPrecision precision = PrecisionOf(model, summary);
  precision.steadiness.step =
      ConfirmFocalStep(adjustment_options, layout, corner_errors, &seed, precision.steadiness.step);
  AddDoubts(registration, &precision);
  return precision;
}

}  // namespace velamap
