// The systematic part of a calibration's residuals: neighbouring residuals that agree show a lens
// that the camera model does not describe.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/calibration/board_views.h"

namespace velamap {

// Projection minus observation of a corner that took part.
struct CalibrationResidual {
  Eigen::Vector2d x_in_image_px, residual_px;
};

// The residuals in one cell of a grid.
struct ResidualCell {
  int num_corners = 0;
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
  double rms_px = 0.0;  // of their lengths
};

std::vector<ResidualCell> ResidualsInCells(const std::vector<CalibrationResidual>& residuals,
                                           const PictureGrid& grid);

// RMS over the corners of their cell's mean residual, minus what independent residuals would leave
// in a mean. Cells with fewer than eight corners do not count.
double SystematicResidual(const std::vector<ResidualCell>& cells);

}  // namespace velamap
