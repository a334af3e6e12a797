#include "tests/support/render/shadows.h"

#include <cmath>
#include <random>

#include "importer/geometry/units.h"

namespace velamap {

std::vector<Shadow> DrawShadows(int num_shadows, double depth, std::uint32_t seed) {
  std::mt19937 random(seed + 53);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);
  };
  const auto log_between = [&](double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  };
  std::vector<Shadow> shadows(static_cast<std::size_t>(num_shadows));
  for (std::size_t i = 0; i < shadows.size(); ++i) {
    Shadow& shadow = shadows[i];
    const double angle = between(0, kPi), motion = between(0, 2 * kPi);
    shadow.place = {between(0.05, 0.95), between(0.05, 0.95)};
    shadow.direction = {std::cos(angle), std::sin(angle)};
    shadow.width_m = log_between(0.005, 0.5);
    shadow.edge_m = log_between(0.001, 0.1);
    shadow.depth = depth * between(0.3, 1);
    const double path = between(0.02, 0.2);
    if (i % 2 == 1)
      shadow.motion_in_clip = path * Eigen::Vector2d(std::cos(motion), std::sin(motion));
  }
  return shadows;
}

void AddShadow(const Shadow& shadow, const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px,
               double px_per_m, cv::Mat* surfaces) {
  constexpr double kReach = 4.0;  // sigmas of the edges
  const Eigen::Vector2d along = (to_px - from_px).normalized();
  if (!along.allFinite()) return;
  const double half_px = 0.5 * shadow.width_m * px_per_m, edge_px = shadow.edge_m * px_per_m;
  const auto below = [&](double x_px) {
    return 0.5 * std::erfc(-x_px / (std::sqrt(2.0) * edge_px));
  };
  surfaces->forEach<cv::Vec2f>([&](cv::Vec2f& sums, const int* place) {
    const Eigen::Vector2d x_px(place[1] + 0.5, place[0] + 0.5);
    const double across_px =
        std::abs(along.x() * (x_px.y() - from_px.y()) - along.y() * (x_px.x() - from_px.x()));
    if (across_px > half_px + kReach * edge_px) return;
    const double shade = below(across_px + half_px) - below(across_px - half_px);
    sums[0] *= static_cast<float>(1 - shadow.depth * shade);
  });
}

}  // namespace velamap
