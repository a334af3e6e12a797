#include "tests/support/render/board_renderer.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "importer/geometry/units.h"
#include "tests/support/render/picture_effects.h"

namespace velamap {
namespace {

constexpr int kBorderBits = 1, kWhiteCells = 1;  // of a marker, and around it on a ChArUco

double GrayOnBoard(const PrintedBoard& board, const Eigen::Vector2d& x_m,
                   const BoardRenderOptions& options) {
  const int column = static_cast<int>(std::floor(x_m.x() / board.cell_m + 0.5 * board.cells.cols));
  const int row = static_cast<int>(std::floor(0.5 * board.cells.rows - x_m.y() / board.cell_m));
  if (column < 0 || row < 0 || column >= board.cells.cols || row >= board.cells.rows) {
    return options.background;
  }
  return board.cells.at<std::uint8_t>(row, column) > 0 ? options.white : options.black;
}

// The directions in the cam frame through the corners of all pixels, row by row; directions within
// a pixel are interpolated.
std::vector<Eigen::Vector3d> RaysOfPixelCorners(const Camera& camera) {
  std::vector<Eigen::Vector3d> rays;
  for (int y = 0; y <= camera.height_px; ++y) {
    for (int x = 0; x <= camera.width_px; ++x) {
      const auto ray = CamFromImage(camera, {x, y});
      rays.push_back(ray ? Eigen::Vector3d(ray->homogeneous()) : Eigen::Vector3d(0, 0, -1));
    }
  }
  return rays;
}

}  // namespace

PrintedBoard PrintChessboard(const Chessboard& board, double square_m) {
  PrintedBoard print{cv::Mat(board.num_rows + 3, board.num_columns + 3, CV_8U, cv::Scalar(255)),
                     square_m};
  for (int row = 0; row <= board.num_rows; ++row) {
    for (int column = row % 2; column <= board.num_columns; column += 2) {
      print.cells.at<std::uint8_t>(row + 1, column + 1) = 0;
    }
  }
  return print;
}

Eigen::Vector3d ChessboardCorner(const Chessboard& board, double square_m, int column, int row) {
  return {square_m * (column - 0.5 * (board.num_columns - 1)),
          square_m * (0.5 * (board.num_rows - 1) - row), 0.0};
}

PrintedBoard PrintCharuco(int num_columns, int num_rows, const Dictionary& dictionary,
                          double marker_m) {
  const int marker = CellsPerSide(dictionary, kBorderBits);
  const int square = marker + 2 * kWhiteCells;
  PrintedBoard print{
      cv::Mat((num_rows + 1) * square, (num_columns + 1) * square, CV_8U, cv::Scalar(255)),
      marker_m / marker};
  int marker_id = 0;
  for (int row = 0; row < num_rows; ++row) {
    for (int column = 0; column < num_columns; ++column) {
      cv::Mat cells = print.cells(
          cv::Rect(square / 2 + column * square, square / 2 + row * square, square, square));
      if ((row + column) % 2 == 0) {
        cells.setTo(0);
        continue;
      }
      MarkerCells(dictionary, marker_id++, kBorderBits)
          .copyTo(cells(cv::Rect(kWhiteCells, kWhiteCells, marker, marker)));
    }
  }
  return print;
}

PrintedBoard PrintMarkerGrid(int num_columns, int num_rows, const Dictionary& dictionary,
                             double marker_m) {
  const int marker = CellsPerSide(dictionary, kBorderBits);
  const int gap = marker / 2, step = marker + gap;
  PrintedBoard print{
      cv::Mat(num_rows * step + gap, num_columns * step + gap, CV_8U, cv::Scalar(255)),
      marker_m / marker};
  for (int i = 0; i < num_rows * num_columns; ++i) {
    const cv::Rect place(gap + i % num_columns * step, gap + i / num_columns * step, marker,
                         marker);
    MarkerCells(dictionary, i, kBorderBits).copyTo(print.cells(place));
  }
  return print;
}

cv::Mat RenderBoard(const Camera& camera, const Rigid3& cam_from_board, const PrintedBoard& board,
                    const BoardRenderOptions& options) {
  const Rigid3 board_from_cam = Inverse(cam_from_board);
  const Camera fine_camera = FineCamera(camera);
  const std::vector<Eigen::Vector3d> rays = RaysOfPixelCorners(fine_camera);
  const int num = options.supersampling;
  cv::Mat fine(fine_camera.height_px, fine_camera.width_px, CV_32F);
  const auto gray_at = [&](const Eigen::Vector3d& ray) {
    const Eigen::Vector3d direction = board_from_cam.rotation * ray;
    const double depth = -board_from_cam.translation.z() / direction.z();
    if (!(depth > 0)) return options.background;
    const Eigen::Vector3d on_board = board_from_cam.translation + depth * direction;
    return GrayOnBoard(board, on_board.head<2>(), options);
  };
  for (int y = 0; y < fine.rows; ++y) {
    for (int x = 0; x < fine.cols; ++x) {
      const Eigen::Vector3d* above = &rays[static_cast<std::size_t>(y * (fine.cols + 1) + x)];
      const Eigen::Vector3d* below = above + fine.cols + 1;
      double sum = 0.0;
      for (int i = 0; i < num * num; ++i) {
        // No two samples of a pixel share a row or column, which matters for edges along these.
        const double u = (i % num + (i / num + 0.5) / num) / num;
        const double v = (i / num + (i % num + 0.5) / num) / num;
        sum += gray_at((1 - v) * ((1 - u) * above[0] + u * above[1]) +
                       v * ((1 - u) * below[0] + u * below[1]));
      }
      fine.at<float>(y, x) = static_cast<float>(sum / (num * num));
    }
  }
  LensBlur(options.blur_sigma_px, &fine);
  cv::Mat picture = OnSensor(fine);
  std::mt19937 generator(options.seed);
  std::normal_distribution<float> noise(0.0F, static_cast<float>(options.noise_sigma));
  if (options.noise_sigma > 0) {
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) picture.at<float>(y, x) += noise(generator);
    }
  }
  cv::Mat gray;
  picture.convertTo(gray, CV_8U);
  return gray;
}

std::vector<Rigid3> DrawBoardPoses(const Camera& camera, const PrintedBoard& board, int num_poses,
                                   std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Eigen::Vector2d half_m =
      0.5 * board.cell_m * Eigen::Vector2d(board.cells.cols, board.cells.rows);
  const double focal_px = MeanFocalLength(camera);
  std::vector<Rigid3> poses;
  while (static_cast<int>(poses.size()) < num_poses) {
    const double distance_m =
        2 * half_m.x() * focal_px / camera.width_px * (1.5 + 0.4 * uniform(generator));
    const auto ray = CamFromImage(camera, {camera.width_px * (0.5 + 0.3 * uniform(generator)),
                                           camera.height_px * (0.5 + 0.3 * uniform(generator))});
    const Eigen::Vector3d axis =
        Eigen::Vector3d(uniform(generator), uniform(generator), 0.0).normalized();
    const Eigen::Quaterniond rotation =
        Eigen::AngleAxisd(0.6 * std::abs(uniform(generator)), axis) *
        Eigen::AngleAxisd(0.5 * uniform(generator), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
    const Rigid3 cam_from_board{rotation, distance_m * ray->homogeneous()};
    bool is_inside = true;
    for (const double x_m : {-half_m.x(), half_m.x()}) {
      for (const double y_m : {-half_m.y(), half_m.y()}) {
        const auto x_px = ImageFromCam(camera, cam_from_board * Eigen::Vector3d(x_m, y_m, 0.0));
        is_inside = is_inside && x_px && (x_px->array() > 0).all() && x_px->x() < camera.width_px &&
                    x_px->y() < camera.height_px;
      }
    }
    if (is_inside) poses.push_back(cam_from_board);
  }
  return poses;
}

}  // namespace velamap
