#include "importer/edge_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "importer/interpolate.h"
#include "importer/unit_square_map.h"

namespace velamap {
namespace {

using Quad = std::array<Eigen::Vector2d, kNumCorners>;

constexpr double kQuietZoneCells = 1.0;  // what every marker has; more does no harm

Side MakeSide(const Quad& quad) {
  Side side{0.5 * (quad[0] + quad[1]),
            (quad[1] - quad[0]).normalized(),
            {},
            0.5 * (quad[1] - quad[0]).norm()};
  side.outward = {side.along.y(), -side.along.x()};
  if (side.outward.dot(quad[2] + quad[3] - 2 * side.middle_px) > 0) side.outward *= -1;
  return side;
}

// Grey values along a line parallel to the side, at v in the unit square.
GrayLine ReadLine(const cv::Mat& gray, const UnitSquareMap& map, double v) {
  GrayLine line;
  for (int i = 0; i < kNumPlaces; ++i) {
    line[static_cast<std::size_t>(i)] =
        InterpolateGray(gray, map.ToImage(i / (kNumPlaces - 1.0), v));
  }
  return line;
}

double Mean(const GrayLine& line) {
  double sum = 0.0;
  for (const double value : line) sum += value;
  return sum / kNumPlaces;
}

double LookUp(const GrayLine& line, double u) {
  const double place = std::clamp(u, 0.0, 1.0) * (kNumPlaces - 1.001);
  const auto index = static_cast<std::size_t>(place);
  return line[index] + (place - static_cast<double>(index)) * (line[index + 1] - line[index]);
}

LinearInS FromEnds(double at_start, double at_end) {
  return {0.5 * (at_start + at_end), 0.5 * (at_end - at_start)};
}

Parallel MakeParallel(const Side& side, const UnitSquareMap& map, double v) {
  const auto depth_px = [&](double u) {
    return std::abs((map.ToImage(u, v) - side.middle_px).dot(side.outward));
  };
  const Parallel line{FromEnds(depth_px(0), depth_px(1)), {}};
  const auto facing_u = [&](double s) {
    const double outwards_px = v > 0 ? -line.depth_px(s) : line.depth_px(s);
    return map
        .ToSquare(side.middle_px + s * side.half_length_px * side.along +
                  outwards_px * side.outward)
        .x();
  };
  return {line.depth_px, FromEnds(facing_u(-1), facing_u(1))};
}

// Share of a step that lies on the far side, for the sides that end this one.
double Step(double distance_px, double blur_px) {
  if (distance_px > 3.5 * blur_px) return 1.0;
  return 0.5 * std::erfc(-distance_px / blur_px * 0.70710678118654752);
}

EdgeSample MakeSample(const SideModel& model, const Eigen::Vector2d& x_px, double along_px,
                      double distance_px, double gray) {
  EdgeSample sample;
  sample.s = along_px / model.side.half_length_px;
  sample.distance_px = distance_px;
  sample.gray = gray;
  for (const Side* neighbour : {&model.previous, &model.next}) {
    sample.cover *= Step(-(x_px - neighbour->middle_px).dot(neighbour->outward), model.blur_px);
  }
  sample.inner = std::max(0.0, LookUp(model.inner_gray, model.inner.u(sample.s)) - model.dark);
  sample.outer = std::min(0.0, LookUp(model.outer_gray, model.outer.u(sample.s)) - model.light);
  sample.inner_depth_px = model.inner.depth_px(sample.s);
  sample.outer_depth_px = model.outer.depth_px(sample.s);
  return sample;
}

}  // namespace

SideModel MakeSideModel(const cv::Mat& gray, const Quad& quad, int side_idx, int num_cells,
                        double blur_px) {
  const auto turned = [&](int turns) {
    Quad result;
    for (int i = 0; i < kNumCorners; ++i) {
      result[static_cast<std::size_t>(i)] =
          quad[static_cast<std::size_t>((i + turns) % kNumCorners)];
    }
    return result;
  };
  const Quad own = turned(side_idx);
  const UnitSquareMap map(own);
  const double cell = 1.0 / num_cells;
  SideModel model;
  model.side = MakeSide(own);
  model.previous = MakeSide(turned(side_idx + kNumCorners - 1));
  model.next = MakeSide(turned(side_idx + 1));
  model.inner_gray = ReadLine(gray, map, 1.5 * cell);
  model.outer_gray = ReadLine(gray, map, -(kQuietZoneCells + 0.5) * cell);
  model.inner = MakeParallel(model.side, map, cell);
  model.outer = MakeParallel(model.side, map, -kQuietZoneCells * cell);
  model.dark = Mean(ReadLine(gray, map, 0.5 * cell));
  model.light = Mean(ReadLine(gray, map, -0.5 * kQuietZoneCells * cell));
  model.blur_px = blur_px;
  return model;
}

void SampleSide(const cv::Mat& gray, const SideModel& model, double band_px, int max_samples,
                EdgeSamples* samples) {
  const Side& side = model.side;
  const double margin_px =
      std::clamp(0.24 * side.half_length_px, model.blur_px, 2.5 * model.blur_px);
  const double reach_px = side.half_length_px - margin_px;
  const int major = std::abs(side.along.x()) >= std::abs(side.along.y()) ? 0 : 1;
  const int minor = 1 - major;
  const double major_reach =
      reach_px * std::abs(side.along[major]) + band_px * std::abs(side.outward[major]);
  const double minor_reach = band_px / std::abs(side.outward[minor]);
  const int stride =
      static_cast<int>(std::ceil(4 * reach_px * band_px / std::min(max_samples, kMaxEdgeSamples)));
  const int major_size = major == 0 ? gray.cols : gray.rows;
  const int minor_size = major == 0 ? gray.rows : gray.cols;
  const int first = std::max(0, static_cast<int>(std::ceil(side.middle_px[major] - major_reach)));
  const int last =
      std::min(major_size - 1, static_cast<int>(std::floor(side.middle_px[major] + major_reach)));
  samples->count = 0;
  for (int i = first; i <= last; i += stride) {
    const double center =
        side.middle_px[minor] + (i - side.middle_px[major]) * side.along[minor] / side.along[major];
    const int begin = std::max(0, static_cast<int>(std::ceil(center - minor_reach)));
    const int end = std::min(minor_size - 1, static_cast<int>(std::floor(center + minor_reach)));
    for (int j = begin; j <= end; ++j) {
      Eigen::Vector2d x_px;
      x_px[major] = i;
      x_px[minor] = j;
      const double along_px = (x_px - side.middle_px).dot(side.along);
      if (std::abs(along_px) > reach_px || samples->count == kMaxEdgeSamples) continue;
      const double distance_px = (x_px - side.middle_px).dot(side.outward);
      const double value = major == 0 ? gray.at<std::uint8_t>(j, i) : gray.at<std::uint8_t>(i, j);
      samples->values[static_cast<std::size_t>(samples->count++)] =
          MakeSample(model, x_px, along_px, distance_px, value);
    }
  }
}

EdgePrior MakeEdgePrior(const SideModel& model) {
  const double contrast = model.light - model.dark;
  const double half_length = model.side.half_length_px;
  using P = EdgeParameters;
  EdgePrior prior;
  P& mean = prior.mean;
  mean[P::kBlur] = model.blur_px;
  mean[P::kDark] = model.dark;
  mean[P::kLight] = model.light;
  mean[P::kInnerGain] = mean[P::kOuterGain] = 1.0;
  P& sigma = prior.sigma;
  sigma[P::kOffset] = sigma[P::kSlope] = 1e3;
  sigma[P::kBend] = 2e-3 * half_length + 5e-4 * half_length * half_length;
  sigma[P::kBlur] = 0.5;
  sigma[P::kDark] = sigma[P::kLight] = 1e3;
  sigma[P::kDarkSlope] = sigma[P::kLightSlope] = 0.1 * contrast;
  sigma[P::kInnerGain] = sigma[P::kOuterGain] = 0.3;
  return prior;
}

}  // namespace velamap
