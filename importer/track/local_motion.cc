#include "importer/track/local_motion.h"

#include <algorithm>

namespace velamap {
namespace {

constexpr std::size_t kNumNearestPoints = 5;

// Points with a smaller spread do not determine rotation and scale, since each is known to a pixel.
constexpr double kSmallSpreadPx = 50.0;

}  // namespace

// With q = from - mean(from) and d the displacement minus its mean, the similarity's linear part (s
// -r; r s) minimizes sum |d - (s q + r J q)|^2 + spread^2 (s^2 + r^2), where J is a quarter turn.
Eigen::Vector2d LocalMotion(const std::vector<PointMotion>& motions,
                            const Eigen::Vector2d& point_px) {
  if (motions.empty()) return Eigen::Vector2d::Zero();
  std::vector<PointMotion> nearest = motions;
  const std::size_t count = std::min(kNumNearestPoints, nearest.size());
  std::stable_sort(nearest.begin(), nearest.end(), [&](const PointMotion& a, const PointMotion& b) {
    return (a.from_px - point_px).norm() < (b.from_px - point_px).norm();
  });
  nearest.resize(count);
  Eigen::Vector2d mean_from = Eigen::Vector2d::Zero(), mean_displacement = Eigen::Vector2d::Zero();
  for (const PointMotion& motion : nearest) {
    mean_from += motion.from_px / static_cast<double>(count);
    mean_displacement += (motion.to_px - motion.from_px) / static_cast<double>(count);
  }
  double scale = 0.0, turn = 0.0, weight = kSmallSpreadPx * kSmallSpreadPx;
  for (const PointMotion& motion : nearest) {
    const Eigen::Vector2d q = motion.from_px - mean_from;
    const Eigen::Vector2d d = motion.to_px - motion.from_px - mean_displacement;
    scale += q.dot(d);
    turn += q.x() * d.y() - q.y() * d.x();
    weight += q.squaredNorm();
  }
  const Eigen::Vector2d q = point_px - mean_from;
  return mean_displacement + scale / weight * q + turn / weight * Eigen::Vector2d(-q.y(), q.x());
}

}  // namespace velamap
