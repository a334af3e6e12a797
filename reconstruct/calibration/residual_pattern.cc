#include "reconstruct/calibration/residual_pattern.h"

#include <algorithm>
#include <cmath>

namespace velamap {

std::vector<ResidualCell> ResidualsInCells(const std::vector<CalibrationResidual>& residuals,
                                           const PictureGrid& grid) {
  std::vector<ResidualCell> cells(static_cast<std::size_t>(grid.NumCells()));
  for (const CalibrationResidual& residual : residuals) {
    ResidualCell& cell = cells[static_cast<std::size_t>(grid.CellOf(residual.x_in_image_px))];
    ++cell.num_corners;
    cell.mean_px += residual.residual_px;
    cell.rms_px += residual.residual_px.squaredNorm();
  }
  for (ResidualCell& cell : cells) {
    if (cell.num_corners == 0) continue;
    cell.mean_px /= cell.num_corners;
    cell.rms_px = std::sqrt(cell.rms_px / cell.num_corners);
  }
  return cells;
}

double SystematicResidual(const std::vector<ResidualCell>& cells) {
  constexpr int kMinCorners = 8;
  double sum_px2 = 0.0;
  int num_corners = 0;
  for (const ResidualCell& cell : cells) {
    if (cell.num_corners < kMinCorners) continue;
    const double mean_px2 = cell.mean_px.squaredNorm();
    const double scatter_px2 = cell.rms_px * cell.rms_px - mean_px2;
    sum_px2 += cell.num_corners * (mean_px2 - scatter_px2 / (cell.num_corners - 1));
    num_corners += cell.num_corners;
  }
  return num_corners > 0 ? std::sqrt(std::max(0.0, sum_px2 / num_corners)) : 0.0;
}

}  // namespace velamap
