#include "importer/detect/chessboard.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "importer/camera/camera.h"
#include "importer/detect/corner_colors.h"
#include "importer/detect/interpolate.h"

namespace velamap {
namespace {

// 1 sigma of a corner's coordinate as a fraction of the width of an edge, from a tenth to nine
// tenths of its contrast. On rendered boards the errors are 0.1 to 1.5 sigmas.
constexpr double kSigmaOfEdgeWidth = 0.02;
// Half a window around a corner as a fraction of the distance to the nearest other one, so that the
// window holds the edges of no other corner.
constexpr double kWindowOfSquare = 0.4;
// Limits of half a window, in px and in widths of an edge. The lens bends the edges, and an edge of
// curvature k shifts the corner by up to 0.13 k w^2 for half a window of w. In squares of 200 px of
// a wide action camera at 4K this is 0.4 px if only the square limits the window, and 0.01 px with
// 12 px. A blurred edge needs a wider window; the shift then stays far below a sigma.
constexpr double kMaxWindowPx = 12.0, kMaxWindowOfEdgeWidth = 2.0;

// The corners in the image, as (row, column).
using CornerGrid = cv::Mat_<cv::Point2f>;

CornerGrid QuarterTurned(const CornerGrid& grid) {
  CornerGrid turned;
  cv::rotate(grid, turned, cv::ROTATE_90_CLOCKWISE);
  return turned;
}

// Whether the turn from columns to rows is opposite to the turn from x to y of the image.
bool IsMirrored(const CornerGrid& grid) {
  const cv::Point2f x = grid(0, grid.cols - 1) - grid(0, 0);
  const cv::Point2f y = grid(grid.rows - 1, 0) - grid(0, 0);
  return x.cross(y) < 0;
}

// Grey level in the middle of the square whose first corner is in this column and row.
double GrayOfSquare(const cv::Mat& gray, const CornerGrid& grid, int column, int row) {
  return NearestGray(gray, 0.25F * (grid(row, column) + grid(row, column + 1) +
                                    grid(row + 1, column) + grid(row + 1, column + 1)));
}

bool BeginsDark(const cv::Mat& gray, const CornerGrid& grid) {
  return GrayOfSquare(gray, grid, 0, 0) < GrayOfSquare(gray, grid, 1, 0);
}

// How well the columns run to the right and the rows downwards: at most 2.
double Uprightness(const CornerGrid& grid) {
  const cv::Point2f x = grid(0, grid.cols - 1) - grid(0, 0);
  const cv::Point2f y = grid(grid.rows - 1, 0) - grid(0, 0);
  return x.x / cv::norm(x) + y.y / cv::norm(y);
}

// Turns the grid so that its first square is dark, if any turn does that. Of several such turns,
// chooses the most upright one.
CornerGrid Oriented(const cv::Mat& gray, CornerGrid grid) {
  if (IsMirrored(grid)) cv::flip(grid.clone(), grid, 0);
  std::vector<CornerGrid> turns;
  CornerGrid turned = grid;
  for (int quarter = 0; quarter < 4; ++quarter, turned = QuarterTurned(turned)) {
    if (turned.cols == grid.cols) turns.push_back(turned);
  }
  const auto light = std::stable_partition(
      turns.begin(), turns.end(), [&](const CornerGrid& turn) { return BeginsDark(gray, turn); });
  if (light != turns.begin()) turns.erase(light, turns.end());
  return *std::max_element(turns.begin(), turns.end(), [](const auto& a, const auto& b) {
    return Uprightness(a) < Uprightness(b);
  });
}

// The first corners of the blocks of two along `num` corners. If the number is odd, one in the
// middle is left out, because the outer ones are the most informative about the lens.
std::vector<int> BlockBegins(int num) {
  const int num_blocks = num / 2;
  std::vector<int> begins;
  for (int i = 0; i < num_blocks; ++i) {
    const bool is_behind_middle = num % 2 == 1 && 2 * i >= num_blocks;
    begins.push_back(2 * i + (is_behind_middle ? 1 : 0));
  }
  return begins;
}

double SquareSidePx(const CornerGrid& grid, int column, int row) {
  double side_px = std::numeric_limits<double>::infinity();
  const auto try_neighbor = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= grid.cols || y >= grid.rows) return;
    side_px = std::min(side_px, cv::norm(grid(y, x) - grid(row, column)));
  };
  try_neighbor(column - 1, row);
  try_neighbor(column + 1, row);
  try_neighbor(column, row - 1);
  try_neighbor(column, row + 1);
  return side_px;
}

// Moves the corners to where the lines through the gradients of their edges meet. The corners of
// the search are off by up to a pixel, most in small, blurred or noise-free pictures.
CornerGrid Refined(const cv::Mat& gray, const CornerGrid& grid, double edge_width_px) {
  constexpr int kMinHalfWindowPx = 2, kMaxIterations = 30;
  constexpr double kLeastStepPx = 1e-3;
  const cv::TermCriteria criteria(cv::TermCriteria::EPS + cv::TermCriteria::MAX_ITER,
                                  kMaxIterations, kLeastStepPx);
  const double max_window_px = std::max(kMaxWindowPx, kMaxWindowOfEdgeWidth * edge_width_px);
  CornerGrid refined(grid.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.cols; ++column) {
      const double of_square_px = kWindowOfSquare * SquareSidePx(grid, column, row);
      const int half_window_px =
          std::max(kMinHalfWindowPx, cvRound(std::min(max_window_px, of_square_px)));
      std::vector<cv::Point2f> corner_px{grid(row, column)};
      cv::cornerSubPix(gray, corner_px, {half_window_px, half_window_px}, {-1, -1}, criteria);
      refined(row, column) = corner_px[0];
    }
  }
  return refined;
}

double EdgeWidthPx(const cv::Mat& gray, const CornerGrid& grid) {
  const std::vector<cv::Point2f> corners_px(grid.begin(), grid.end());
  return cv::estimateChessboardSharpness(gray, grid.size(), corners_px)[0];
}

}  // namespace

Chessboard ParseChessboard(const std::string& text, const std::string& option) {
  const std::size_t x = text.find('x');
  Chessboard board;
  const auto is_valid = [](int num) {
    return num >= kMinChessboardCorners && num <= kMaxChessboardCorners;
  };
  if (x == std::string::npos || !ParseNumber(text.substr(0, x), &board.num_columns) ||
      !ParseNumber(text.substr(x + 1), &board.num_rows) || !is_valid(board.num_columns) ||
      !is_valid(board.num_rows)) {
    throw InputError(
        fmt::format("{}: '{}' is not the size of a chessboard; give its inner corners, where four "
                    "squares meet, as "
                    "COLUMNSxROWS such as 9x6, each from {} to {}",
                    option, text, kMinChessboardCorners, kMaxChessboardCorners));
  }
  return board;
}

std::string ChessboardName(const Chessboard& board) {
  return fmt::format("chessboard of {} x {} inner corners", board.num_columns, board.num_rows);
}

FrameDetections DetectChessboard(const Chessboard& board, const Frame& frame) {
  FrameDetections detections{frame.image_name, frame.frame_number, frame.time_s, {}, {}};
  std::vector<cv::Point2f> found_px;
  if (!cv::findChessboardCornersSB(frame.gray, {board.num_columns, board.num_rows}, found_px,
                                   cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return detections;
  }
  CornerGrid grid =
      Oriented(frame.gray, CornerGrid(board.num_rows, board.num_columns, found_px.data()));
  const double edge_width_px = EdgeWidthPx(frame.gray, grid);
  grid = Refined(frame.gray, grid, edge_width_px);
  const double sigma_px = kSigmaOfEdgeWidth * edge_width_px;
  constexpr auto kShiftPx = static_cast<float>(kImageFromOpenCvPx);
  for (const int row : BlockBegins(board.num_rows)) {
    for (const int column : BlockBegins(board.num_columns)) {
      MarkerDetection marker;
      marker.marker_id = static_cast<int>(detections.markers.size());
      const std::array<cv::Point2f, kNumCorners> corners_px = {
          grid(row, column), grid(row, column + 1), grid(row + 1, column + 1),
          grid(row + 1, column)};
      for (std::size_t c = 0; c < corners_px.size(); ++c) {
        marker.corners_in_image_px[c] = {corners_px[c].x + kShiftPx, corners_px[c].y + kShiftPx};
      }
      marker.corner_sigma_px.fill(sigma_px);
      detections.markers.push_back(marker);
    }
  }
  AddColors(frame, &detections);
  return detections;
}

}  // namespace velamap
