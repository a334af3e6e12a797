// Pictures of flat calibration boards with exact truth, as marker_renderer.h has of markers.

#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/chessboard.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/dictionary.h"

namespace velamap {

// The board frame has its origin in the middle of the print, x along its rows and y up, its face
// towards +z.
struct PrintedBoard {
  cv::Mat cells;        // 8 bit, 0 for black and 255 for white, with the white margin
  double cell_m = 0.0;  // side of a cell
};

// The square above and left of the first inner corner is black. One square of margin.
PrintedBoard PrintChessboard(const Chessboard& board, double square_m);
// The inner corner in the board frame, m; columns from the left, rows from the top.
Eigen::Vector3d ChessboardCorner(const Chessboard& board, double square_m, int column, int row);

// Markers of `dictionary` from id 0, row by row, with a cell of white around them, in the white
// squares of a chessboard (ChArUco) of num_columns x num_rows squares.
PrintedBoard PrintCharuco(int num_columns, int num_rows, const Dictionary& dictionary,
                          double marker_m);
// The same markers on white, half a marker apart.
PrintedBoard PrintMarkerGrid(int num_columns, int num_rows, const Dictionary& dictionary,
                             double marker_m);

struct BoardRenderOptions {
  double black = 40.0, white = 200.0, background = 120.0;  // grey levels
  double blur_sigma_px = 0.7;
  double noise_sigma = 0.0;  // grey levels
  int supersampling = 4;
  std::uint32_t seed = 1;  // of the noise
};

cv::Mat RenderBoard(const Camera& camera, const Rigid3& cam_from_board, const PrintedBoard& board,
                    const BoardRenderOptions& options);

// A board in all parts of the picture, tilted to all sides and wholly inside.
std::vector<Rigid3> DrawBoardPoses(const Camera& camera, const PrintedBoard& board, int num_poses,
                                   std::uint32_t seed);

}  // namespace velamap
