#include "importer/detect/chessboard.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/base/statistics.h"
#include "importer/geometry/units.h"
#include "tests/support/error_matchers.h"
#include "tests/support/render/board_renderer.h"

namespace velamap {
namespace {

constexpr double kSquare_m = 0.03;
const Camera kCamera{CameraModel::kOpenCV, 320, 240, {260, 260, 161, 119, -0.1, 0.02, 0, 0}};

Frame FrameOf(const cv::Mat& gray) {
  Frame frame;
  frame.image_name = "board.png";
  frame.gray = gray;
  cv::cvtColor(gray, frame.color, cv::COLOR_GRAY2BGR);
  return frame;
}

Rigid3 Facing(double turn_deg) {
  const Eigen::Quaterniond rotation =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(kRadPerDeg * turn_deg, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
  return {rotation, {0.01, -0.005, 0.45}};
}

// Errors of the coordinates of the detected corners, px, where the columns run along x or back.
std::vector<double> ErrorsPx(const FrameDetections& detections, const Chessboard& board,
                             const Camera& camera, const Rigid3& cam_from_board,
                             bool is_half_turned) {
  std::vector<double> errors;
  const int blocks = board.num_columns / 2;
  for (const MarkerDetection& marker : detections.markers) {
    const int i = marker.marker_id % blocks, j = marker.marker_id / blocks;
    for (int c = 0; c < kNumCorners; ++c) {
      int column =
          2 * i + (board.num_columns % 2 == 1 && 2 * i >= blocks ? 1 : 0) + (c == 1 || c == 2);
      int row = 2 * j + (board.num_rows % 2 == 1 && 2 * j >= board.num_rows / 2 ? 1 : 0) + (c >= 2);
      if (is_half_turned) {
        column = board.num_columns - 1 - column;
        row = board.num_rows - 1 - row;
      }
      const Eigen::Vector2d error_px =
          marker.corners_in_image_px[static_cast<std::size_t>(c)] -
          *ImageFromCam(camera, cam_from_board * ChessboardCorner(board, kSquare_m, column, row));
      errors.insert(errors.end(), {error_px.x(), error_px.y()});
    }
  }
  return errors;
}

// The same in their sigmas, with kCamera.
std::vector<double> ErrorsInSigmas(const FrameDetections& detections, const Chessboard& board,
                                   const Rigid3& cam_from_board, bool is_half_turned) {
  std::vector<double> errors = ErrorsPx(detections, board, kCamera, cam_from_board, is_half_turned);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    errors[i] /= detections.markers[i / 8].corner_sigma_px[i % 8 / 2];
  }
  return errors;
}

TEST(Chessboard, CornersOfItsSquaresAreThoseOfMarkers) {
  const Chessboard board{7, 6};
  std::vector<double> errors;
  for (const double blur_px : {0.6, 1.2}) {
    for (std::uint32_t seed = 1; seed <= 2; ++seed) {
      BoardRenderOptions options;
      options.blur_sigma_px = blur_px;
      options.noise_sigma = 2.0;
      options.seed = seed;
      const Rigid3 pose = Facing(10.0 * seed);
      const FrameDetections found = DetectChessboard(
          board, FrameOf(RenderBoard(kCamera, pose, PrintChessboard(board, kSquare_m), options)));
      ASSERT_EQ(static_cast<int>(found.markers.size()), board.NumMarkers());
      for (const double error : ErrorsInSigmas(found, board, pose, false)) errors.push_back(error);
    }
  }
  EXPECT_LT(Rms(errors), 2.0);
  EXPECT_GT(Rms(errors), 0.3);
}

TEST(Chessboard, BentEdgesOfLargeSquaresDoNotMoveCorners) {
  const Chessboard board{6, 4};
  const Camera wide{CameraModel::kOpenCV, 1280, 960, {600, 600, 641, 479, -0.25, 0.04, 0, 0}};
  const Rigid3 pose{Facing(0).rotation, {0.005, -0.005, 0.13}};
  const FrameDetections found = DetectChessboard(
      board, FrameOf(RenderBoard(wide, pose, PrintChessboard(board, kSquare_m), {})));
  ASSERT_EQ(static_cast<int>(found.markers.size()), board.NumMarkers());
  EXPECT_LT(Rms(ErrorsPx(found, board, wide, pose, false)), 0.05);
}

TEST(Chessboard, ABoardThatLooksDifferentTurnedKeepsItsFirstCorner) {
  const Chessboard board{7, 6};
  ASSERT_FALSE(board.LooksTheSameTurned());
  for (const double turn_deg : {0.0, 95.0, 260.0}) {
    const Rigid3 pose = Facing(turn_deg);
    const FrameDetections found = DetectChessboard(
        board, FrameOf(RenderBoard(kCamera, pose, PrintChessboard(board, kSquare_m), {})));
    ASSERT_EQ(static_cast<int>(found.markers.size()), board.NumMarkers()) << turn_deg;
    EXPECT_LT(Rms(ErrorsInSigmas(found, board, pose, false)), 3.0) << turn_deg;
  }
}

TEST(Chessboard, ABoardThatLooksTheSameIsTakenToBeUpright) {
  const Chessboard board{8, 6};
  ASSERT_TRUE(board.LooksTheSameTurned());
  for (const double turn_deg : {60.0, 120.0}) {
    const Rigid3 pose = Facing(turn_deg);
    const FrameDetections found = DetectChessboard(
        board, FrameOf(RenderBoard(kCamera, pose, PrintChessboard(board, kSquare_m), {})));
    ASSERT_EQ(static_cast<int>(found.markers.size()), board.NumMarkers()) << turn_deg;
    EXPECT_LT(Rms(ErrorsInSigmas(found, board, pose, turn_deg > 90)), 3.0) << turn_deg;
  }
}

TEST(Chessboard, ABoardOfAnotherSizeIsNotFound) {
  const cv::Mat gray = RenderBoard(kCamera, Facing(0), PrintChessboard({7, 6}, kSquare_m), {});
  EXPECT_TRUE(DetectChessboard({9, 8}, FrameOf(gray)).markers.empty());
  EXPECT_TRUE(DetectChessboard({7, 6}, FrameOf(cv::Mat(240, 320, CV_8U, 128))).markers.empty());
}

TEST(Chessboard, ItsSizeIsColumnsByRows) {
  const Chessboard board = ParseChessboard("9x6", "--Board.chessboard");
  EXPECT_EQ(board.num_columns, 9);
  EXPECT_EQ(board.num_rows, 6);
  for (const char* text : {"", "9", "9x", "x6", "9x6x2", "3x9", "9x-6", "9x1000", "9 x 6"}) {
    ExpectThrows<InputError>([&] { ParseChessboard(text, "--Board.chessboard"); },
                             {"--Board.chessboard: ", "inner corners"});
  }
}

}  // namespace
}  // namespace velamap
