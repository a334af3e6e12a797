#include "tests/support/chessboard_renderer.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "importer/camera/camera_projection.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// In squares from the middle of the inner corners, y up.
double GrayOnBoard(const Chessboard& board, const Eigen::Vector2d& x,
                   const ChessboardRenderOptions& options) {
  // Columns and rows of squares from the top left.
  const double column = x.x() + 0.5 * (board.num_columns + 1);
  const double row = 0.5 * (board.num_rows + 1) - x.y();
  const int num_columns = board.num_columns + 1, num_rows = board.num_rows + 1;
  const double margin = options.margin_squares;
  if (column < -margin || row < -margin || column > num_columns + margin ||
      row > num_rows + margin) {
    return options.background;
  }
  if (column < 0 || row < 0 || column >= num_columns || row >= num_rows) return options.white;
  const int parity = (static_cast<int>(column) + static_cast<int>(row)) % 2;
  return parity == 0 ? options.black : options.white;
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

cv::Mat RenderChessboard(const Camera& camera, const Rigid3& cam_from_board,
                         const Chessboard& board, const ChessboardRenderOptions& options) {
  const Rigid3 board_from_cam = Inverse(cam_from_board);
  const std::vector<Eigen::Vector3d> rays = RaysOfPixelCorners(camera);
  const int num = options.supersampling;
  cv::Mat picture(camera.height_px, camera.width_px, CV_32F);
  const auto gray_at = [&](const Eigen::Vector3d& ray) {
    const Eigen::Vector3d direction = board_from_cam.rotation * ray;
    const double depth = -board_from_cam.translation.z() / direction.z();
    if (!(depth > 0)) return options.background;
    const Eigen::Vector3d on_board = board_from_cam.translation + depth * direction;
    return GrayOnBoard(board, on_board.head<2>() / options.square_m, options);
  };
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const Eigen::Vector3d* above = &rays[static_cast<std::size_t>(y * (picture.cols + 1) + x)];
      const Eigen::Vector3d* below = above + picture.cols + 1;
      double sum = 0.0;
      for (int i = 0; i < num * num; ++i) {
        const double u = (i % num + 0.5) / num, v = (i / num + 0.5) / num;
        sum += gray_at((1 - v) * ((1 - u) * above[0] + u * above[1]) +
                       v * ((1 - u) * below[0] + u * below[1]));
      }
      picture.at<float>(y, x) = static_cast<float>(sum / (num * num));
    }
  }
  if (options.blur_sigma_px > 0) cv::GaussianBlur(picture, picture, {0, 0}, options.blur_sigma_px);
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

Eigen::Vector3d ChessboardCorner(const Chessboard& board, double square_m, int column, int row) {
  return {square_m * (column - 0.5 * (board.num_columns - 1)),
          square_m * (0.5 * (board.num_rows - 1) - row), 0.0};
}

std::vector<Rigid3> DrawBoardPoses(const Camera& camera, const Chessboard& board, double square_m,
                                   int num_poses, std::uint32_t seed) {
  constexpr double kMargin = 1.5;  // of squares, beyond the outer corners
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double width_m = square_m * (board.num_columns + 2);
  const double focal_px = MeanFocalLength(camera);
  std::vector<Rigid3> poses;
  while (static_cast<int>(poses.size()) < num_poses) {
    const double distance_m =
        width_m * focal_px / camera.width_px * (1.6 + 0.5 * uniform(generator));
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
    for (const double column : {-kMargin, board.num_columns - 1 + kMargin}) {
      for (const double row : {-kMargin, board.num_rows - 1 + kMargin}) {
        const Eigen::Vector3d x_in_board(square_m * (column - 0.5 * (board.num_columns - 1)),
                                         square_m * (0.5 * (board.num_rows - 1) - row), 0.0);
        const auto x_px = ImageFromCam(camera, cam_from_board * x_in_board);
        is_inside = is_inside && x_px && (x_px->array() > 0).all() && x_px->x() < camera.width_px &&
                    x_px->y() < camera.height_px;
      }
    }
    if (is_inside) poses.push_back(cam_from_board);
  }
  return poses;
}

}  // namespace velamap
