// Calibration boards on one page: markers in a grid, or in the white squares of a chessboard.

#pragma once

#include <optional>
#include <vector>

#include "importer/print/placement.h"
#include "importer/print/sheet_drawing.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

enum class BoardKind { kGrid, kCharuco };

struct Board {
  BoardKind kind = BoardKind::kGrid;
  PageFrame frame;
  int num_columns = 0, num_rows = 0;  // of markers, or of the squares of a chessboard
  double spacing_mm = 0.0;            // between marker centres; or side of a chessboard square
  double length_mm = 0.0;             // side of a marker
  int num_markers = 0;                // ids count from first_id, row by row from the top left
  int first_id = 0;
  std::vector<Eigen::Vector2d> marker_min_mm;  // top left corners of the markers, page frame
  std::vector<Eigen::Vector2d> square_min_mm;  // top left corners of a chessboard's black squares
};

// Places the board in the middle of the page, in portrait or landscape, whichever allows larger
// cells. Without a length, the spacing is the largest whole number of millimetres that fits.
// `num_cells` counts the cells along a marker's side, with the border. A chessboard has the squares
// and ids of cv::aruco::CharucoBoard from OpenCV 4.6 on, and also of earlier versions if the number
// of rows is odd. Throws InputError, naming the option, if the board does not fit on the paper, if
// the spacing does not exceed the marker's side, and if a chessboard has no white square.
Board PlanBoard(BoardKind kind, const GridPlacementOptions& grid, const Paper& paper,
                std::optional<double> length_m, int num_cells, int first_id);

Drawing DrawBoard(const Board& board, const PrintedLook& look, const SheetWords& words);

}  // namespace velamap
