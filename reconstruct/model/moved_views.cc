#include "reconstruct/model/moved_views.h"

#include <algorithm>

#include "importer/base/natural_order.h"

namespace velamap {
namespace {

Eigen::Vector2d MeanError(const TrackedView& view) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& error_px : view.errors_px) sum += error_px;
  return sum / kNumCorners;
}

bool IsDisplacedAsAWhole(const TrackedView& view) {
  constexpr double kMaxOfSide = 0.7;
  constexpr double kMaxScatter = 0.5;  // of the corners, relative to the displacement
  const Eigen::Vector2d mean_px = MeanError(view);
  double squares = 0.0;
  for (const Eigen::Vector2d& error_px : view.errors_px) {
    squares += (error_px - mean_px).squaredNorm();
  }
  const double displacement_px = mean_px.norm();
  return displacement_px < kMaxOfSide * view.side_px &&
         squares < kNumCorners * kMaxScatter * kMaxScatter * displacement_px * displacement_px;
}

// Whether the views before and after, either of them or their mean, show most of the displacement.
bool IsPartOfAMotion(const std::vector<TrackedView>& views, std::size_t i) {
  constexpr double kMaxChange = 0.6;
  const Eigen::Vector2d displacement_px = MeanError(views[i]);
  const auto is_near = [&](const Eigen::Vector2d& other_px) {
    return (other_px - displacement_px).norm() < kMaxChange * displacement_px.norm();
  };
  const bool has_before = i > 0, has_after = i + 1 < views.size();
  if (has_before && is_near(MeanError(views[i - 1]))) return true;
  if (has_after && is_near(MeanError(views[i + 1]))) return true;
  return has_before && has_after &&
         is_near(0.5 * (MeanError(views[i - 1]) + MeanError(views[i + 1])));
}

}  // namespace

std::vector<bool> FindMovedViews(const std::vector<TrackedView>& views) {
  constexpr double kMinShare = 0.05;
  constexpr double kMinCount = 3.0;
  std::vector<bool> is_moved(views.size(), false);
  double num_moved = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views[i].is_outlier || !IsDisplacedAsAWhole(views[i])) continue;
    is_moved[i] = IsPartOfAMotion(views, i);
    if (is_moved[i]) num_moved += 1.0;
  }
  const double needed = std::max(kMinCount, kMinShare * static_cast<double>(views.size()));
  if (num_moved < needed) is_moved.assign(views.size(), false);
  return is_moved;
}

std::map<ImageId, std::size_t> OrderInTime(const Model& model) {
  std::vector<const ModelImage*> images;
  for (const ModelImage& image : model.images) images.push_back(&image);
  std::sort(images.begin(), images.end(),
            [](const ModelImage* a, const ModelImage* b) { return NaturalLess(a->name, b->name); });
  std::map<ImageId, std::size_t> places;
  for (std::size_t i = 0; i < images.size(); ++i) places.emplace(images[i]->image_id, i);
  return places;
}

}  // namespace velamap
