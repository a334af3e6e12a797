// Renders pictures of flat calibration boards with exact truth. marker_renderer.h does so for
// markers.

#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/chessboard.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/dictionary.h"

namespace velamap {

// Board frame, m: the origin is the middle of the print, x is along its rows, y up, and the printed
// side faces +z.
struct PrintedBoard {
  cv::Mat cells;        // 8 bit, 0 for black and 255 for white, with the white margin
  double cell_m = 0.0;  // side of a cell
};

// A chessboard whose top left square is black, with a margin of one square.
PrintedBoard PrintChessboard(const Chessboard& board, double square_m);
// The position of an inner corner in the board frame, m. Columns count from the left, rows from the
// top.
Eigen::Vector3d ChessboardCorner(const Chessboard& board, double square_m, int column, int row);

// A ChArUco board of num_columns x num_rows squares. The markers of `dictionary` from id 0 on are
// in its white squares, row by row, with one white cell around each.
PrintedBoard PrintCharuco(int num_columns, int num_rows, const Dictionary& dictionary,
                          double marker_m);
// A grid of num_columns x num_rows markers on white, from id 0 on, half a marker apart.
PrintedBoard PrintMarkerGrid(int num_columns, int num_rows, const Dictionary& dictionary,
                             double marker_m);

struct BoardRenderOptions {
  double black = 40.0, white = 200.0, background = 120.0;  // grey levels
  double blur_sigma_px = 0.7;
  double noise_sigma = 0.0;  // grey levels
  int supersampling = 2;     // number of samples along each side of half a pixel
  std::uint32_t seed = 1;    // of the noise
};

cv::Mat RenderBoard(const Camera& camera, const Rigid3& cam_from_board, const PrintedBoard& board,
                    const BoardRenderOptions& options);

// Random cam_from_board poses with the board anywhere in the picture, tilted to all sides, and
// wholly visible.
std::vector<Rigid3> DrawBoardPoses(const Camera& camera, const PrintedBoard& board, int num_poses,
                                   std::uint32_t seed);

}  // namespace velamap
