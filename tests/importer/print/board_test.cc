#include "importer/print/board.h"

#include <gtest/gtest.h>
#include <opencv2/aruco/charuco.hpp>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

GridPlacementOptions Grid(int rows, int columns) {
  GridPlacementOptions grid;
  grid.num_rows = rows;
  grid.num_columns = columns;
  return grid;
}

// Markers of OpenCV's board in the frame of its top left corner, y down.
void ExpectMarkersOf(const cv::aruco::Board& opencv, const Board& board,
                     const Eigen::Vector2d& origin_mm) {
  ASSERT_EQ(opencv.ids.size(), board.marker_min_mm.size());
  for (std::size_t i = 0; i < opencv.ids.size(); ++i) {
    EXPECT_EQ(opencv.ids[i], static_cast<int>(i));
    const cv::Point3f top_left = opencv.objPoints[i][0];
    EXPECT_NEAR(board.marker_min_mm[i].x() - origin_mm.x(), top_left.x, 1e-3) << i;
    EXPECT_NEAR(board.marker_min_mm[i].y() - origin_mm.y(), top_left.y, 1e-3) << i;
  }
}

// Compares the squares with those in the picture that OpenCV draws.
void ExpectSquaresOf(const cv::aruco::CharucoBoard& opencv, const Board& board,
                     const Eigen::Vector2d& origin_mm) {
  constexpr int kSquarePx = 60;
  cv::Mat picture;
  const_cast<cv::aruco::CharucoBoard&>(opencv).draw(
      cv::Size(kSquarePx * board.num_columns, kSquarePx * board.num_rows), picture, 0, 1);
  int num_black = 0;
  for (int row = 0; row < board.num_rows; ++row) {
    for (int column = 0; column < board.num_columns; ++column) {
      // Close to its corner a square is black, or the white around a marker.
      num_black += picture.at<std::uint8_t>(kSquarePx * row + 3, kSquarePx * column + 3) == 0;
    }
  }
  EXPECT_EQ(static_cast<std::size_t>(num_black), board.square_min_mm.size());
  for (const Eigen::Vector2d& min_mm : board.square_min_mm) {
    const Eigen::Vector2d place = kSquarePx / board.spacing_mm * (min_mm - origin_mm);
    EXPECT_EQ(
        picture.at<std::uint8_t>(static_cast<int>(place.y()) + 3, static_cast<int>(place.x()) + 3),
        0);
  }
}

TEST(PlanBoard, CharucoIsOpenCvs) {
  const auto dictionary = LoadDictionary("DICT_4X4_50").aruco;
  for (const auto& [rows, columns] : {std::pair(5, 7), std::pair(4, 6), std::pair(7, 5)}) {
    const Board board = PlanBoard(BoardKind::kCharuco, Grid(rows, columns), {"A4"}, 0.021, 6, 0);
    EXPECT_DOUBLE_EQ(board.spacing_mm, 30);
    const auto opencv = cv::aruco::CharucoBoard::create(columns, rows, 30.0f, 21.0f, dictionary);
    Eigen::Vector2d origin = board.square_min_mm.front();
    for (const Eigen::Vector2d& square : board.square_min_mm) origin = origin.cwiseMin(square);
    ExpectMarkersOf(*opencv, board, origin);
    ExpectSquaresOf(*opencv, board, origin);
  }
}

TEST(PlanBoard, GridIsOpenCvs) {
  GridPlacementOptions grid = Grid(4, 5);
  grid.spacing_m = 0.035;
  const Board board = PlanBoard(BoardKind::kGrid, grid, {"A4"}, 0.025, 6, 0);
  const auto opencv =
      cv::aruco::GridBoard::create(5, 4, 25.0f, 10.0f, LoadDictionary("DICT_4X4_50").aruco);
  ExpectMarkersOf(*opencv, board, board.marker_min_mm.front());
}

TEST(PlanBoard, FillsThePaperWithoutALength) {
  for (const BoardKind kind : {BoardKind::kGrid, BoardKind::kCharuco}) {
    for (const auto& [rows, columns] : {std::pair(5, 7), std::pair(9, 4), std::pair(2, 2)}) {
      const Board board = PlanBoard(kind, Grid(rows, columns), {"A4"}, std::nullopt, 6, 3);
      EXPECT_EQ(board.spacing_mm, std::round(board.spacing_mm));
      EXPECT_EQ(board.first_id, 3);
      Eigen::Vector2d high = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& min_mm : board.marker_min_mm) {
        EXPECT_GE((min_mm - board.frame.min_mm).minCoeff(), -1e-6);
        EXPECT_GE((board.frame.max_mm - min_mm).minCoeff(), board.length_mm - 1e-6);
        // White as far as the corner fit looks, up to the paper's edge.
        EXPECT_GE(min_mm.minCoeff(), DefaultMargin(board.length_mm, 6) - 1e-6);
        high = high.cwiseMax(min_mm);
      }
      GridPlacementOptions larger = Grid(rows, columns);
      larger.spacing_m = (board.spacing_mm + 1) / 1000;
      EXPECT_THROW(PlanBoard(kind, larger, {"A4"}, std::nullopt, 6, 3), InputError);
    }
  }
}

TEST(PlanBoard, BadSizesNameTheOption) {
  ExpectThrows<InputError>([] { PlanBoard(BoardKind::kGrid, Grid(5, 7), {"A4"}, 0.1, 6, 0); },
                           {"--Sheet.paper: A4", "too small", "--marker_length"});
  GridPlacementOptions grid = Grid(2, 2);
  grid.spacing_m = 0.02;
  ExpectThrows<InputError>([&] { PlanBoard(BoardKind::kGrid, grid, {"A4"}, 0.02, 6, 0); },
                           {"--Grid.spacing", "more than their side"});
  ExpectThrows<InputError>([] { PlanBoard(BoardKind::kCharuco, Grid(1, 1), {"A4"}, 0.02, 6, 0); },
                           {"--Grid.rows", "no marker"});
}

}  // namespace
}  // namespace velamap
