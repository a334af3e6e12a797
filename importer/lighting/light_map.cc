#include "importer/lighting/light_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The map as columns that are scaled by the roots of the weights.
struct WeightedMap {
  Eigen::MatrixXd smooth;             // orthonormal: light that is even, slopes and curves
  Eigen::VectorXd root_weight, lack;  // what `smooth` does not explain

  explicit WeightedMap(const LightMap& map) {
    const auto n = static_cast<Eigen::Index>(map.parts.size());
    smooth.resize(n, 6);
    root_weight.resize(n);
    lack.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const LightMap::Part& part = map.parts[static_cast<std::size_t>(i)];
      const double x = part.place.x(), y = part.place.y();
      root_weight[i] = std::sqrt(part.weight);
      smooth.row(i) << 1, x, y, x * x, x * y, y * y;
      smooth.row(i) *= root_weight[i];
      lack[i] = root_weight[i] * part.lack;
    }
    for (Eigen::Index k = 0; k < smooth.cols(); ++k) {
      for (Eigen::Index j = 0; j < k; ++j) {
        smooth.col(k) -= smooth.col(j).dot(smooth.col(k)) * smooth.col(j);
      }
      smooth.col(k) /= std::max(smooth.col(k).norm(), 1e-9);
    }
    lack -= smooth * (smooth.transpose() * lack);
  }
};

}  // namespace

LightMap MapLight(const std::vector<LitPixel>& pixels) {
  constexpr int kParts = 10;
  constexpr double kReach = 0.5;  // of the diagonal, on either side of the middle
  struct Sums {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    double by_residual = 0.0, squares = 0.0;
    int count = 0;
  };
  std::array<Sums, kParts * kParts> sums;
  const auto part_of = [](double x) {
    return std::clamp(static_cast<int>((x + kReach) / (2 * kReach) * kParts), 0, kParts - 1);
  };
  for (const LitPixel& pixel : pixels) {
    Sums& part = sums[static_cast<std::size_t>(part_of(pixel.place.y()) * kParts +
                                               part_of(pixel.place.x()))];
    const double square = pixel.by_log_light * pixel.by_log_light;
    part.place += square * pixel.place;
    part.by_residual += pixel.by_log_light * pixel.residual;
    part.squares += square;
    ++part.count;
  }
  LightMap map;
  double total = 0.0, between = 0.0, weights = 0.0;
  int num_pixels = 0;
  for (const LitPixel& pixel : pixels) total += pixel.residual * pixel.residual;
  for (const Sums& part : sums) {
    if (part.count == 0 || !(part.squares > 0)) continue;
    const double lack = -part.by_residual / part.squares;
    map.parts.push_back({part.place / part.squares, lack, part.squares});
    between += lack * lack * part.squares;
    weights += part.squares;
    num_pixels += part.count;
  }
  const auto num_parts = static_cast<double>(map.parts.size());
  if (num_pixels > 2 * num_parts) {
    const double variance = (total - between) / (num_pixels - num_parts);
    map.excess = between / num_parts / std::max(variance, 1e-9);
    map.amplitude = std::sqrt(between / weights);
  }
  return map;
}

FoundBand FindBand(const LightMap& map) {
  constexpr int kAngles = 16, kOffsets = 17;
  constexpr double kLeastOffset = -0.5, kBlur = 0.04, kMinShare = 0.02;
  constexpr double kMinDepth = -3.0, kMaxDepth = 0.8;
  const WeightedMap weighted(map);
  const Eigen::Index n = weighted.lack.size();
  const auto ramp = [](double x) { return std::clamp(0.5 + x / (2.5 * kBlur), 0.0, 1.0); };
  FoundBand best;
  best.band << 0, 0, 0, std::log(kBlur), 0;
  double most = 0.0;
  Eigen::VectorXd along(n), inside(n);
  for (int a = 0; a < kAngles; ++a) {
    const double angle = kPi * a / kAngles;
    const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
    for (Eigen::Index i = 0; i < n; ++i) {
      along[i] = normal.dot(map.parts[static_cast<std::size_t>(i)].place);
    }
    for (int o = 0; o < kOffsets; ++o) {
      const double offset = kLeastOffset + o / (kOffsets - 1.0);
      for (const double width : {0.06, 0.12, 0.25, 2.0}) {
        for (Eigen::Index i = 0; i < n; ++i) {
          inside[i] =
              weighted.root_weight[i] * (ramp(along[i] - offset) - ramp(along[i] - offset - width));
        }
        const double all = inside.squaredNorm();
        const double own = all - (weighted.smooth.transpose() * inside).squaredNorm();
        if (!(own > kMinShare * all)) continue;
        const double by_lack = inside.dot(weighted.lack), explained = by_lack * by_lack / own;
        if (explained <= most) continue;
        most = explained;
        best.band << angle, offset, std::log(width), std::log(kBlur),
            std::clamp(1 - std::exp(by_lack / own), kMinDepth, kMaxDepth);
      }
    }
  }
  double all = 0.0;
  for (const LightMap::Part& part : map.parts) all += part.weight * part.lack * part.lack;
  best.unexplained = (weighted.lack.squaredNorm() - most) / std::max(all, 1e-9);
  return best;
}

}  // namespace velamap
