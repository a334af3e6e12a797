// Boards for calibration: markers in a grid, or in the white squares of a chessboard, on one page.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/print/placement.h"
#include "importer/print/sheet_drawing.h"
#include "importer/print/sheet_plan.h"

namespace velamap {

enum class BoardKind { kGrid, kCharuco };

struct Board {
  BoardKind kind = BoardKind::kGrid;
  PageFrame frame;
  int num_columns = 0, num_rows = 0;  // of markers, or of a chessboard's squares
  double spacing_mm = 0.0;            // between centres; side of a square
  double length_mm = 0.0;             // of a marker
  int num_markers = 0;                // with ids from first_id on, row by row from the top left
  int first_id = 0;
  std::vector<Eigen::Vector2d> marker_min_mm;  // top left corner of the black squares, by marker
  std::vector<Eigen::Vector2d> square_min_mm;  // of a chessboard's black squares
};

// In the middle of the page, upright or turned, whichever has more room. Without a length, the
// markers are as large as the paper allows, in whole millimetres of spacing. The squares and ids of
// a chessboard are those of cv::aruco::CharucoBoard from OpenCV 4.6 on, and of earlier versions if
// the number of rows is odd. Throws InputError, naming the option, for a board that the paper has
// no room for, and for a spacing below the marker's side.
Board PlanBoard(BoardKind kind, const GridPlacementOptions& grid, const Paper& paper,
                std::optional<double> length_m, int num_cells, int first_id);

Drawing DrawBoard(const Board& board, const PrintedLook& look, const SheetWords& words);

}  // namespace velamap
