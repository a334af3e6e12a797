#include "importer/lighting/light_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "importer/geometry/units.h"
#include "importer/lanes/float_lanes.h"

namespace velamap {
namespace {

constexpr int kSmooth = 6;  // light that is even, slopes and curves

// Values of the parts, in groups of lanes; what stands for no part is zero.
struct PartGroup {
  Floats x, y;
  // Scaled by the root of the weight: one, an orthonormal base of the smooth light, and what it
  // does not explain of the lack.
  Floats root_weight, lack;
  FloatsArray<kSmooth> smooth;
};

std::vector<PartGroup> GroupParts(const LightMap& map) {
  const auto n = static_cast<Eigen::Index>(map.parts.size());
  Eigen::MatrixXd smooth(n, kSmooth);
  Eigen::VectorXd root_weight(n), lack(n);
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
  std::vector<PartGroup> groups((map.parts.size() + kLanes - 1) / kLanes, PartGroup{});
  for (Eigen::Index i = 0; i < n; ++i) {
    PartGroup& group = groups[static_cast<std::size_t>(i / kLanes)];
    const auto lane = static_cast<int>(i % kLanes);
    const Eigen::Vector2d& place = map.parts[static_cast<std::size_t>(i)].place;
    group.x[lane] = static_cast<float>(place.x());
    group.y[lane] = static_cast<float>(place.y());
    group.root_weight[lane] = static_cast<float>(root_weight[i]);
    group.lack[lane] = static_cast<float>(lack[i]);
    for (int k = 0; k < kSmooth; ++k) {
      group.smooth[k][lane] = static_cast<float>(smooth(i, k));
    }
  }
  return groups;
}

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

VELAMAP_CLONE_FOR_AVX2 FoundBand FindBand(const LightMap& map) {
  constexpr int kAngles = 16, kOffsets = 17;
  constexpr double kLeastOffset = -0.5, kBlur = 0.04, kMinShare = 0.02;
  constexpr double kMinDepth = -3.0, kMaxDepth = 0.8;
  const std::vector<PartGroup> groups = GroupParts(map);
  // Rises from 0 to 1 across an edge at zero.
  const auto ramp = [](Floats x) {
    return Min(Max(0.5f + x * static_cast<float>(1 / (2.5 * kBlur)), AllLanes(0.0)), AllLanes(1.0));
  };
  FoundBand best;
  best.band << 0, 0, 0, std::log(kBlur), 0;
  double most = 0.0;
  // How far parts are beyond the first edge, and the share of them that is.
  struct Beyond {
    Floats distance, share;
  };
  std::vector<Beyond> beyond(groups.size());
  for (int a = 0; a < kAngles; ++a) {
    const double angle = kPi * a / kAngles;
    const Floats normal_x = AllLanes(std::cos(angle)), normal_y = AllLanes(std::sin(angle));
    for (int o = 0; o < kOffsets; ++o) {
      const double offset = kLeastOffset + o / (kOffsets - 1.0);
      for (std::size_t g = 0; g < groups.size(); ++g) {
        const Floats distance = normal_x * groups[g].x + normal_y * groups[g].y - AllLanes(offset);
        beyond[g] = {distance, ramp(distance)};
      }
      for (const double width : {0.06, 0.12, 0.25, 2.0}) {
        Floats squares{}, by_lack_lanes{};
        FloatsArray<kSmooth> by_smooth{};
        for (std::size_t g = 0; g < groups.size(); ++g) {
          const PartGroup& group = groups[g];
          const Floats inside =
              group.root_weight * (beyond[g].share - ramp(beyond[g].distance - AllLanes(width)));
          squares += inside * inside;
          by_lack_lanes += inside * group.lack;
          for (int k = 0; k < kSmooth; ++k) by_smooth[k] += inside * group.smooth[k];
        }
        const double all = Sum(squares), by_lack = Sum(by_lack_lanes);
        double own = all;
        for (int k = 0; k < kSmooth; ++k) own -= std::pow(Sum(by_smooth[k]), 2);
        if (!(own > kMinShare * all)) continue;
        const double explained = by_lack * by_lack / own;
        if (explained <= most) continue;
        most = explained;
        best.band << angle, offset, std::log(width), std::log(kBlur),
            std::clamp(1 - std::exp(by_lack / own), kMinDepth, kMaxDepth);
      }
    }
  }
  double all = 0.0, lack = 0.0;
  for (const LightMap::Part& part : map.parts) all += part.weight * part.lack * part.lack;
  for (const PartGroup& group : groups) lack += Sum(group.lack * group.lack);
  best.unexplained = (lack - most) / std::max(all, 1e-9);
  return best;
}

}  // namespace velamap
