// Pictures of a chessboard with exact truth, as marker_renderer.h has of markers.

#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/detect/chessboard.h"
#include "importer/geometry/rigid3.h"

namespace velamap {

struct ChessboardRenderOptions {
  double square_m = 0.03;
  double black = 40.0, white = 200.0, background = 120.0;  // grey levels
  double margin_squares = 1.0;                             // white, around the squares
  double blur_sigma_px = 0.7;
  double noise_sigma = 0.0;  // grey levels
  int supersampling = 4;
  std::uint32_t seed = 1;  // of the noise
};

// The board frame has its origin in the middle of the inner corners, x along the columns and y up,
// its face towards +z. The square above and left of the first inner corner is black.
cv::Mat RenderChessboard(const Camera& camera, const Rigid3& cam_from_board,
                         const Chessboard& board, const ChessboardRenderOptions& options);

// The inner corner in the board frame, m; columns from the left, rows from the top.
Eigen::Vector3d ChessboardCorner(const Chessboard& board, double square_m, int column, int row);

// A board in all parts of the picture, tilted to all sides and wholly inside.
std::vector<Rigid3> DrawBoardPoses(const Camera& camera, const Chessboard& board, double square_m,
                                   int num_poses, std::uint32_t seed);

}  // namespace velamap
