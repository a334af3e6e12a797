#include "workflows/check/marker_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

constexpr double kMinContrast = 8.0;

std::optional<double> GrayAt(const cv::Mat& gray, const Eigen::Vector2d& x_in_image_px) {
  // Pixel centres are at halves.
  const double x = x_in_image_px.x() - 0.5, y = x_in_image_px.y() - 0.5;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  if (column < 0 || row < 0 || column + 1 >= gray.cols || row + 1 >= gray.rows) {
    return std::nullopt;
  }
  const double right = x - column, down = y - row;
  const auto at = [&](int r, int c) { return static_cast<double>(gray.at<std::uint8_t>(r, c)); };
  return (1 - down) * ((1 - right) * at(row, column) + right * at(row, column + 1)) +
         down * ((1 - right) * at(row + 1, column) + right * at(row + 1, column + 1));
}

// Across one side.
struct Edge {
  double black = 0.0, white = 0.0, blur_px = 0.0;
};

// Of a black-white edge that is blurred by a normal distribution, the steepest slope is the
// contrast divided by sqrt(2 pi) sigmas.
std::optional<Edge> MeasureEdge(const cv::Mat& gray, const Eigen::Vector2d& from,
                                const Eigen::Vector2d& to) {
  constexpr double kReachSides = 0.1, kStep_px = 0.25;
  const Eigen::Vector2d along = to - from;
  const Eigen::Vector2d outwards = Eigen::Vector2d(along.y(), -along.x()).normalized();
  const double reach_px = std::max(1.5, kReachSides * along.norm());
  std::vector<double> profile;
  for (double offset_px = -reach_px; offset_px <= reach_px; offset_px += kStep_px) {
    double sum = 0.0;
    for (const double part : {0.4, 0.5, 0.6}) {
      const auto value = GrayAt(gray, from + part * along + offset_px * outwards);
      if (!value) return std::nullopt;
      sum += *value / 3;
    }
    profile.push_back(sum);
  }
  Edge edge;
  edge.black = *std::min_element(profile.begin(), profile.end());
  edge.white = *std::max_element(profile.begin(), profile.end());
  constexpr std::size_t kSpan = 4;  // a pixel
  double steepest = 0.0;
  for (std::size_t i = kSpan; i < profile.size(); ++i) {
    steepest = std::max(steepest, (profile[i] - profile[i - kSpan]) / (kSpan * kStep_px));
  }
  if (edge.white - edge.black < kMinContrast || steepest <= 0) return std::nullopt;
  edge.blur_px = (edge.white - edge.black) / (std::sqrt(2 * M_PI) * steepest);
  return edge;
}

}  // namespace

std::optional<MarkerLight> MeasureLight(const cv::Mat& gray, const QuadCorners& corners_px) {
  std::array<Edge, kNumCorners> edges;
  std::vector<double> blacks, whites;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto edge = MeasureEdge(gray, corners_px[i], corners_px[(i + 1) % edges.size()]);
    if (!edge) return std::nullopt;
    edges[i] = *edge;
    blacks.push_back(edge->black);
    whites.push_back(edge->white);
  }
  const double across_rows = 0.5 * (edges[0].blur_px + edges[2].blur_px);
  const double across_columns = 0.5 * (edges[1].blur_px + edges[3].blur_px);
  return MarkerLight{Median(std::move(blacks)), Median(std::move(whites)),
                     std::min(across_rows, across_columns), std::max(across_rows, across_columns)};
}

}  // namespace velamap
