// Calibrates a camera from pictures of a board: any arrangement of markers that keeps its shape.
//
// 1. Views that cover the picture and show the board tilted in different directions are selected,
//    sharp ones first (calibration/board_views.h).
// 2. An initial camera is estimated as for a reconstruction without a calibration
//    (camera_search.h).
// 3. Poses, camera and all corners of the board are adjusted together; neither a flat board nor
//    exact squares are assumed. Cross-validation selects the camera model
//    (adjust/camera_cross_validation.h), and outliers are removed.
// 4. A test decides whether one camera with an unchanged lens took all pictures
//    (camera/camera_steadiness.h).

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
  // If not set, the model that predicts unseen pictures best.
  std::optional<CameraModel> camera_model;
  int num_threads = 0;  // 0: one per core; never changes the result
};

struct CalibrationView {
  BoardView view;
  double error_px = 0.0;  // RMS over its corners; 0 for a view that was not used
  bool is_used = false;
};

struct CameraCalibration {
  EstimatedCamera camera;
  std::vector<CameraModelScore> scores;
  int num_images = 0;                  // images with at least two markers, without repeated ones
  std::vector<CalibrationView> views;  // the selected ones
  std::vector<CalibrationResidual> residuals;
  int num_outliers = 0;
  Statistics error_px;  // lengths of the residuals
  BoardFlaws board;
  // Readout time, from the first row of a frame to the last, and its sigma; a sigma of 0: not
  // estimated.
  double rolling_shutter_s = 0.0, rolling_shutter_sigma_s = 0.0;
  std::vector<std::string> warnings;

  // The score of the chosen model.
  const CameraModelScore& Score() const;
  std::vector<BoardView> UsedViews() const;
  // The picture divided into `num_cells` cells along its larger side.
  PictureGrid Grid(int num_cells) const;
};

// `guesses` are the cameras of the database, and `formation` is the importer's estimate of tone
// curve, sharpening and ink spread, if there is one. Throws DataError if the pictures come from
// several cameras or from one that was zoomed, if the board does not move in them, and if they do
// not determine the focal length.
CameraCalibration CalibrateCamera(const CameraCalibrationOptions& options,
                                  const std::vector<DatabaseImage>& images,
                                  const std::map<CameraId, Camera>& guesses, const Layout& layout,
                                  const std::optional<FormationEstimate>& formation);

}  // namespace velamap
