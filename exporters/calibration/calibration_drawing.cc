#include "exporters/calibration/calibration_drawing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "exporters/scale/round_number.h"

namespace velamap {
namespace {

std::string Svg(const PictureGrid& grid, const std::string& label, const std::string& content) {
  return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>",
                     grid.width_px, grid.height_px, label, content);
}

struct Cell {
  double x_px, y_px, width_px, height_px;
};

Cell CellAt(const PictureGrid& grid, int idx) {
  const double width_px = static_cast<double>(grid.width_px) / grid.num_columns;
  const double height_px = static_cast<double>(grid.height_px) / grid.num_rows;
  return {width_px * (idx % grid.num_columns), height_px * (idx / grid.num_columns), width_px,
          height_px};
}

}  // namespace

std::string DrawCoverage(const CameraCalibration& calibration) {
  constexpr int kNumCells = 24;
  constexpr double kFaintest = 0.15;
  const PictureGrid grid = calibration.Grid(kNumCells);
  const std::vector<int> counts = CountInCells(calibration.UsedViews(), grid);
  const double most = std::log1p(*std::max_element(counts.begin(), counts.end()));
  std::string content;
  for (int i = 0; i < grid.NumCells(); ++i) {
    const int count = counts[static_cast<std::size_t>(i)];
    if (count == 0) continue;
    const Cell cell = CellAt(grid, i);
    content += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#0b5c8a\" "
        "fill-opacity=\"{:.2f}\"/>",
        cell.x_px, cell.y_px, cell.width_px, cell.height_px,
        kFaintest + (1.0 - kFaintest) * std::log1p(count) / most);
  }
  return Svg(grid, "Coverage of the picture", content);
}

ResidualDrawing DrawResiduals(const CameraCalibration& calibration) {
  constexpr int kNumCells = 16, kMinCorners = 4;
  constexpr std::size_t kMaxNumDots = 4000;
  constexpr double kDotSize = 0.002, kStroke = 0.0025;  // of the larger side
  constexpr double kArrowOfRms = 0.15;                  // of the larger side, at most
  const PictureGrid grid = calibration.Grid(kNumCells);
  const double side_px = std::max(grid.width_px, grid.height_px), cell_px = side_px / kNumCells;
  const std::vector<ResidualCell> cells = ResidualsInCells(calibration.residuals, grid);
  double longest_px = 1e-6;
  for (const ResidualCell& cell : cells) {
    if (cell.num_corners >= kMinCorners) longest_px = std::max(longest_px, cell.mean_px.norm());
  }
  ResidualDrawing drawing;
  // Residuals without a pattern must look small.
  drawing.magnification = RoundDown(std::min(
      cell_px / longest_px, kArrowOfRms * side_px / std::max(calibration.error_px.rms, 1e-6)));
  std::string content;
  const std::size_t stride = calibration.residuals.size() / kMaxNumDots + 1;
  for (std::size_t i = 0; i < calibration.residuals.size(); i += stride) {
    const CalibrationResidual& residual = calibration.residuals[i];
    const double sigmas = residual.residual_px.norm() / std::max(calibration.error_px.rms, 1e-6);
    content += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"#9aa7b3\"/>",
                           residual.x_in_image_px.x(), residual.x_in_image_px.y(),
                           kDotSize * side_px * std::clamp(sigmas, 0.5, 3.0));
  }
  for (int i = 0; i < grid.NumCells(); ++i) {
    const ResidualCell& residual = cells[static_cast<std::size_t>(i)];
    if (residual.num_corners < kMinCorners) continue;
    const Cell cell = CellAt(grid, i);
    const double x_px = cell.x_px + 0.5 * cell.width_px, y_px = cell.y_px + 0.5 * cell.height_px;
    const Eigen::Vector2d arrow_px = drawing.magnification * residual.mean_px;
    content += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{4:.1f}\" fill=\"#a8201a\"/><path d=\"M{0:.1f} "
        "{1:.1f}L{2:.1f} {3:.1f}\" stroke=\"#a8201a\" stroke-width=\"{4:.1f}\"/>",
        x_px, y_px, x_px + arrow_px.x(), y_px + arrow_px.y(), kStroke * side_px);
  }
  drawing.svg = Svg(grid, "Residuals over the picture", content);
  return drawing;
}

}  // namespace velamap
