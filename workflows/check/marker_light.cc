#include "workflows/check/marker_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "importer/base/statistics.h"
#include "importer/detect/interpolate.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kMinCellContrast = 8.0;

// Across one side.
struct Edge {
  double black = 0.0, white = 0.0, blur_px = 0.0;
};

// The steepest slope of a black-white edge that is blurred by a normal distribution is the contrast
// divided by sqrt(2 pi) sigmas.
std::optional<Edge> MeasureEdge(const cv::Mat& gray, const Eigen::Vector2d& from,
                                const Eigen::Vector2d& to) {
  constexpr double kReachSides = 0.1, kStep_px = 0.25;
  const Eigen::Vector2d along = to - from;
  const Eigen::Vector2d outwards = Eigen::Vector2d(along.y(), -along.x()).normalized();
  const double reach_px = std::max(1.5, kReachSides * along.norm());
  const cv::Rect2d inside(0, 0, gray.cols - 1, gray.rows - 1);
  std::vector<double> profile;
  for (double offset_px = -reach_px; offset_px <= reach_px; offset_px += kStep_px) {
    double sum = 0.0;
    for (const double part : {0.4, 0.5, 0.6}) {
      // From COLMAP's image frame to OpenCV's.
      const Eigen::Vector2d x_px =
          from + part * along + offset_px * outwards - Eigen::Vector2d::Constant(0.5);
      if (!inside.contains({x_px.x(), x_px.y()})) return std::nullopt;
      sum += InterpolateGray(gray, x_px) / 3;
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
  if (edge.white - edge.black < kMinCellContrast || steepest <= 0) return std::nullopt;
  edge.blur_px = (edge.white - edge.black) / (std::sqrt(2 * kPi) * steepest);
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
