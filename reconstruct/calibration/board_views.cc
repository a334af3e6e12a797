#include "reconstruct/calibration/board_views.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "importer/base/statistics.h"
#include "importer/geometry/symmetric_eigen.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The sides of a marker in the picture as columns, px; the affine part of its projection.
Eigen::Matrix2d AffineSides(const MarkerDetection& marker) {
  const auto& x_px = marker.corners_in_image_px;
  Eigen::Matrix2d sides;
  sides.col(0) = 0.5 * (x_px[1] - x_px[0] + x_px[2] - x_px[3]);
  sides.col(1) = 0.5 * (x_px[3] - x_px[0] + x_px[2] - x_px[1]);
  return sides;
}

BoardView Describe(const DatabaseImage& image, double unknown_sigma_px) {
  BoardView view;
  view.image_id = image.image_id;
  view.image_name = image.detections.image_name;
  std::vector<double> sigmas_px;
  // Sides times their transpose does not depend on how a marker is turned on the board.
  Eigen::Matrix2d shape = Eigen::Matrix2d::Zero();
  for (const MarkerDetection& marker : image.detections.markers) {
    const Eigen::Matrix2d sides = AffineSides(marker);
    shape += sides * sides.transpose();
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const double sigma_px = marker.corner_sigma_px[i];
      sigmas_px.push_back(sigma_px > 0 ? sigma_px : unknown_sigma_px);
      view.corners_in_image_px.push_back(marker.corners_in_image_px[i]);
    }
  }
  view.corner_sigma_px = Median(std::move(sigmas_px));
  const SymmetricEigen axes = DecomposeSymmetric(shape);
  const Eigen::Vector2d squares = axes.values.cwiseMax(0.0);
  view.tilt_deg = kDegPerRad * std::acos(std::sqrt(squares[0] / std::max(squares[1], 1e-12)));
  const Eigen::Vector2d direction = axes.vectors.col(0);
  view.tilt_direction_deg =
      std::fmod(kDegPerRad * std::atan2(direction.y(), direction.x()) + 360.0, 180.0);
  return view;
}

// What the chosen views show of each cell, by tilt.
class Coverage {
 public:
  Coverage(const PictureGrid& grid, double median_sigma_px)
      : grid_(grid),
        median_sigma_px_(median_sigma_px),
        counts_(static_cast<std::size_t>(grid.NumCells() * BoardView::kNumTilts), 0.0) {}

  double Gain(const BoardView& view) const {
    double gain = 0.0;
    const std::vector<double> added = Added(view);
    for (std::size_t i = 0; i < added.size(); ++i) {
      if (added[i] > 0) gain += std::log1p(added[i] / (1.0 + counts_[i]));
    }
    return gain;
  }

  void Add(const BoardView& view) {
    const std::vector<double> added = Added(view);
    for (std::size_t i = 0; i < added.size(); ++i) counts_[i] += added[i];
  }

 private:
  std::vector<double> Added(const BoardView& view) const {
    constexpr double kMaxRatio = 2.0;  // large markers alone do not make a calibration
    std::vector<double> added(counts_.size(), 0.0);
    const double ratio = std::min(kMaxRatio, median_sigma_px_ / view.corner_sigma_px);
    for (const Eigen::Vector2d& x_px : view.corners_in_image_px) {
      const int idx = view.Tilt() * grid_.NumCells() + grid_.CellOf(x_px);
      added[static_cast<std::size_t>(idx)] += ratio * ratio;
    }
    return added;
  }

  PictureGrid grid_;
  double median_sigma_px_;
  std::vector<double> counts_;
};

}  // namespace

int PictureGrid::CellOf(const Eigen::Vector2d& x_in_image_px) const {
  const auto idx = [](double x, int size_px, int count) {
    return std::clamp(static_cast<int>(std::floor(x * count / size_px)), 0, count - 1);
  };
  return idx(x_in_image_px.y(), height_px, num_rows) * num_columns +
         idx(x_in_image_px.x(), width_px, num_columns);
}

PictureGrid MakePictureGrid(int width_px, int height_px, int num_cells) {
  const double side_px = static_cast<double>(std::max(width_px, height_px)) / num_cells;
  const auto along = [side_px](int size_px) {
    return std::max(1, static_cast<int>(std::lround(size_px / side_px)));
  };
  return {width_px, height_px, along(width_px), along(height_px)};
}

int BoardView::Tilt() const {
  constexpr double kLeastTilt_deg = 15.0, kSector_deg = 45.0;
  if (tilt_deg < kLeastTilt_deg) return 0;
  return 1 + static_cast<int>(std::floor(tilt_direction_deg / kSector_deg + 0.5)) % 4;
}

std::vector<BoardView> DescribeBoardViews(const std::vector<DatabaseImage>& images,
                                          double unknown_sigma_px) {
  constexpr std::size_t kMinMarkers = 2;
  std::vector<BoardView> views;
  for (const DatabaseImage& image : images) {
    if (image.detections.markers.size() < kMinMarkers) continue;
    views.push_back(Describe(image, unknown_sigma_px));
  }
  return views;
}

std::vector<BoardView> WithoutRepeatedViews(const std::vector<BoardView>& views,
                                            double tolerance_px) {
  const auto repeats = [&](const BoardView& before, const BoardView& view) {
    return std::equal(before.corners_in_image_px.begin(), before.corners_in_image_px.end(),
                      view.corners_in_image_px.begin(), view.corners_in_image_px.end(),
                      [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                        return (a - b).norm() <= tolerance_px;
                      });
  };
  std::vector<BoardView> kept;
  for (const BoardView& view : views) {
    if (kept.empty() || !repeats(kept.back(), view)) {
      kept.push_back(view);
    } else if (view.corner_sigma_px < kept.back().corner_sigma_px) {
      kept.back() = view;
    }
  }
  return kept;
}

std::vector<std::size_t> ChooseBoardViews(const std::vector<BoardView>& views,
                                          const PictureGrid& grid, int max_num_views) {
  std::vector<std::size_t> chosen;
  if (views.empty()) return chosen;
  std::vector<double> sigmas_px;
  for (const BoardView& view : views) sigmas_px.push_back(view.corner_sigma_px);
  Coverage coverage(grid, Median(std::move(sigmas_px)));
  std::vector<bool> is_taken(views.size(), false);
  const std::size_t max_count = std::min(views.size(), static_cast<std::size_t>(max_num_views));
  while (chosen.size() < max_count) {
    std::size_t best = views.size();
    double best_gain = -1.0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const double gain = is_taken[i] ? -1.0 : coverage.Gain(views[i]);
      if (gain <= best_gain) continue;
      best = i;
      best_gain = gain;
    }
    is_taken[best] = true;
    coverage.Add(views[best]);
    chosen.push_back(best);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<int> CountInCells(const std::vector<BoardView>& views, const PictureGrid& grid) {
  std::vector<int> counts(static_cast<std::size_t>(grid.NumCells()), 0);
  for (const BoardView& view : views) {
    for (const Eigen::Vector2d& x_px : view.corners_in_image_px) {
      ++counts[static_cast<std::size_t>(grid.CellOf(x_px))];
    }
  }
  return counts;
}

}  // namespace velamap
