#include "importer/refine/saddle_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/detect/cell_means.h"
#include "importer/detect/gray_levels.h"
#include "importer/detect/interpolate.h"
#include "importer/geometry/unit_square_map.h"

namespace velamap {
namespace {

constexpr double kMinCellPx = 4.0;
// The touching square is as dark as the marker to within this fraction of the contrast. A quiet
// zone into which dark squares around it blur stays lighter.
constexpr double kMaxDarkness = 0.35;
// Beside the corner it is this light, relative to the light cells of the marker. Where a narrow
// quiet zone fades into dark ground, it fades twice at the corner, as if a square touched it there.
constexpr double kMinLightBeside = 0.6;

// Corner i is at (u, v) of the unit square.
constexpr std::array<std::array<double, 2>, kNumCorners> kCornersInSquare = {
    {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

// Grey levels between the dark border and the light cells; 0 without light cells.
double ContrastOfCells(const cv::Mat& gray, const UnitSquareMap& map, const cv::Mat& cells) {
  const int n = cells.rows;
  const CellMeans means = MeansOfCells(cells, [&](int column, int row) {
    return InterpolateGray(gray, map.ToImage((column + 0.5) / n, (row + 0.5) / n));
  });
  return means.light ? *means.light - means.dark : 0.0;
}

// Reads the grey levels half a cell from the corner along both sides: inside the marker, twice
// beside it, and opposite. `contrast` is that of the marker's cells.
bool IsSaddle(const cv::Mat& gray, const UnitSquareMap& map, std::size_t corner, int num_cells,
              double contrast) {
  const double u = kCornersInSquare[corner][0], v = kCornersInSquare[corner][1];
  const double out_u = (u > 0.5 ? 0.5 : -0.5) / num_cells;
  const double out_v = (v > 0.5 ? 0.5 : -0.5) / num_cells;
  const auto gray_at = [&](double du, double dv) {
    return InterpolateGray(gray, map.ToImage(u + du, v + dv));
  };
  const double dark = gray_at(-out_u, -out_v);
  const double light = std::min(gray_at(out_u, -out_v), gray_at(-out_u, out_v));
  const double opposite = gray_at(out_u, out_v);
  return light - dark > kMinLightBeside * contrast &&
         opposite - dark < kMaxDarkness * (light - dark);
}

}  // namespace

int RefineSaddleCorners(const cv::Mat& gray, const cv::Mat& cells, double reach_cells,
                        QuadCorners* corners_px) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && cells.type() == CV_8UC1 && cells.rows == cells.cols &&
                cells.rows > 0);
  const int num_cells = cells.rows;
  const double cell_px = QuadMeanSide(*corners_px) / num_cells;
  if (cell_px < kMinCellPx) return 0;
  const UnitSquareMap map(*corners_px);
  const double contrast = ContrastOfCells(gray, map, cells);
  if (contrast < kMinContrast) return 0;
  std::vector<std::size_t> saddles;
  std::vector<cv::Point2f> points;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    if (!IsSaddle(gray, map, i, num_cells, contrast)) continue;
    saddles.push_back(i);
    points.emplace_back(static_cast<float>((*corners_px)[i].x()),
                        static_cast<float>((*corners_px)[i].y()));
  }
  if (saddles.empty()) return 0;
  // The window ends within the cell beside the corner, whose other edges are not part of the
  // saddle.
  const int half_window = std::clamp(static_cast<int>(std::lround(0.7 * cell_px)), 2, 8);
  cv::cornerSubPix(gray, points, cv::Size(half_window, half_window), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 1e-3));
  int num_moved = 0;
  for (std::size_t k = 0; k < saddles.size(); ++k) {
    const Eigen::Vector2d moved_px(points[k].x, points[k].y);
    if ((moved_px - (*corners_px)[saddles[k]]).norm() > reach_cells * cell_px) continue;
    (*corners_px)[saddles[k]] = moved_px;
    ++num_moved;
  }
  return num_moved;
}

}  // namespace velamap
