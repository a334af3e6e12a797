// Chooses the pictures of a board for a calibration: sharp ones that fill the picture with corners
// and show the board tilted in different directions.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"
#include "importer/database/colmap_database.h"

namespace velamap {

// Cells of equal size over a picture, row by row from the top left.
struct PictureGrid {
  int width_px = 0, height_px = 0;
  int num_columns = 0, num_rows = 0;

  int NumCells() const { return num_columns * num_rows; }
  // Index of the cell at the position, or of the nearest cell if it lies outside the picture.
  int CellOf(const Eigen::Vector2d& x_in_image_px) const;
};

// Nearly square cells, `num_cells` along the larger side.
PictureGrid MakePictureGrid(int width_px, int height_px, int num_cells);

// The grid in which coverage is counted.
constexpr int kNumCoverageCells = 8;

struct BoardView {
  ImageId image_id = 0;
  std::string image_name;
  // Median over the corners, px: small in sharp pictures of large markers.
  double corner_sigma_px = 0.0;
  // Angle between board and image plane, from the foreshortening of the markers; good to a few
  // degrees only, because the camera is not known yet.
  double tilt_deg = 0.0;
  // Direction of the foreshortening in the picture, measured from x towards y, 0 to 180.
  double tilt_direction_deg = 0.0;
  std::vector<Eigen::Vector2d> corners_in_image_px;

  static constexpr int kNumTilts = 5;
  // 0: less than 15 degrees; 1 to 4: more, along x, from top left to bottom right, along y, from
  // top right to bottom left.
  int Tilt() const;
};

// The views of the images that show at least two markers, in the same order. `unknown_sigma_px` is
// the sigma of a corner that has none.
std::vector<BoardView> DescribeBoardViews(const std::vector<DatabaseImage>& images,
                                          double unknown_sigma_px);

// Drops views that repeat the one before, i.e. in which no corner has moved by more than
// `tolerance_px`, and keeps the sharpest of them. Otherwise the errors of one picture of a camera
// that stands still would count as the independent errors of many.
std::vector<BoardView> WithoutRepeatedViews(const std::vector<BoardView>& views,
                                            double tolerance_px);

// Greedily takes the view that adds most to the sum, over the cells of `grid` and the tilts, of
// log(1 + corners seen there so far). A corner counts (median of corner_sigma_px over the views /
// corner_sigma_px of its view)^2, but at most 4. Returns the indices of at most `max_num_views`
// views, ascending.
std::vector<std::size_t> ChooseBoardViews(const std::vector<BoardView>& views,
                                          const PictureGrid& grid, int max_num_views);

// The corners in each cell.
std::vector<int> CountInCells(const std::vector<BoardView>& views, const PictureGrid& grid);

}  // namespace velamap
