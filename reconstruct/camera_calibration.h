// Calibrates a camera from pictures of a board: any arrangement of markers that keeps its shape.
//
// 1. Views: those that cover the picture and tilt the board in different directions, sharp ones
//    first (calibration/board_views.h).
// 2. A camera to begin with, found as for a reconstruction without a calibration (camera_search.h).
// 3. An adjustment of poses, camera and all corners of the board, which is assumed neither to be
//    flat nor to have exact squares. Cross-validation chooses the camera model
//    (adjust/camera_cross_validation.h). Outliers are left out.
// 4. A test whether one unchanged camera took the pictures (camera/camera_steadiness.h).

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "importer/base/statistics.h"
#include "importer/camera/calibration_writer.h"
#include "importer/database/colmap_database.h"
#include "importer/layout/layout.h"
#include "reconstruct/adjust/camera_cross_validation.h"
#include "reconstruct/calibration/board_flaws.h"
#include "reconstruct/calibration/board_views.h"
#include "reconstruct/calibration/residual_pattern.h"

namespace velamap {

struct CameraCalibrationOptions {
  int max_num_views = 60;
  // Nothing: the model that predicts unseen pictures best.
  std::optional<CameraModel> camera_model;
  int num_threads = 0;  // 0: one per core; never changes the result
};

struct CalibrationView {
  BoardView view;
  double error_px = 0.0;  // RMS over its corners; 0 for one that was left out
  bool is_used = false;
};

struct CameraCalibration {
  EstimatedCamera camera;
  std::vector<CameraModelScore> scores;
  int num_images = 0;                  // with at least two markers
  std::vector<CalibrationView> views;  // that were chosen
  std::vector<CalibrationResidual> residuals;
  int num_outliers = 0;
  Statistics error_px;  // lengths of the residuals
  BoardFlaws board;
  // Time from the first row of a frame to the last, and its sigma. A sigma of 0: not estimated.
  double rolling_shutter_s = 0.0, rolling_shutter_sigma_s = 0.0;
  std::vector<std::string> warnings;

  // The score of the chosen model.
  const CameraModelScore& Score() const;
  std::vector<BoardView> UsedViews() const;
  // Divides the picture into `num_cells` along its larger side.
  PictureGrid Grid(int num_cells) const;
};

// `guesses` are the cameras of the database. Throws DataError for pictures of several cameras or a
// zoomed one, pictures that are all alike, and those that do not determine the focal length.
CameraCalibration CalibrateCamera(const CameraCalibrationOptions& options,
                                  const std::vector<DatabaseImage>& images,
                                  const std::map<CameraId, Camera>& guesses, const Layout& layout,
                                  const std::optional<FormationEstimate>& formation);

}  // namespace velamap
