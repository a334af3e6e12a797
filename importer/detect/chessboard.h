// Chessboards for the calibration of a camera. The inner corners of a board are grouped into blocks
// of two by two. Each block is a square of the board and serves as a marker, so all later steps are
// the same as for coded markers.
//
// The corners are found by radon checkers (Duda and Frese, "Accurate Detection and Localization of
// Checkerboard Corners for Calibration", BMVC 2018; cv::findChessboardCornersSB), and located by
// the gradients of the edges that meet there (Foerstner and Guelch, "A Fast Operator for Detection
// and Precise Location of Distinct Points, Corners and Centres of Circular Features", ISPRS 1987;
// cv::cornerSubPix).

#pragma once

#include <string>

#include "importer/detect/detection.h"
#include "importer/video/frame_source.h"

namespace velamap {

// The size of a board in inner corners, where four squares meet: 10 x 7 squares have 9 x 6.
struct Chessboard {
  int num_columns = 0, num_rows = 0;

  // If both numbers are odd or both are even, the board looks the same when it is turned by half
  // a turn; where they are equal and even, by a quarter. It is then taken to be held upright,
  // turned by less than 90 (45) degrees.
  bool LooksTheSameTurned() const { return (num_columns + num_rows) % 2 == 0; }
  // 9 x 6 inner corners make 4 x 3 markers; one column in the middle belongs to no marker.
  int NumMarkers() const { return (num_columns / 2) * (num_rows / 2); }
};

inline constexpr int kMinChessboardCorners = 4, kMaxChessboardCorners = 60;

// "9x6", columns and rows from kMinChessboardCorners to kMaxChessboardCorners. Throws InputError
// that begins with `option`.
Chessboard ParseChessboard(const std::string& text, const std::string& option);

// "chessboard of 9 x 6 inner corners"
std::string ChessboardName(const Chessboard& board);

// All markers of the board, or none where not all of its corners are found. Thread-safe.
FrameDetections DetectChessboard(const Chessboard& board, const Frame& frame);

}  // namespace velamap
