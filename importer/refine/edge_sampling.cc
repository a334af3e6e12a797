#include "importer/refine/edge_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "importer/detect/interpolate.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/lanes/normal_lanes.h"

namespace velamap {
namespace {

constexpr double kQuietZoneCells = 1.0;  // the width that every marker has at least

Side MakeSide(const QuadCorners& quad) {
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
        static_cast<float>(InterpolateGray(gray, map.ToImage(i / (kNumPlaces - 1.0), v)));
  }
  return line;
}

double Mean(const GrayLine& line) {
  return std::accumulate(line.begin(), line.end(), 0.0) / kNumPlaces;
}

Floats LookUp(const GrayLine& line, Floats u) {
  const Floats place =
      Min(Max(u, Floats{}), AllLanes(1.0)) * static_cast<float>(kNumPlaces - 1.001);
  const Ints index = __builtin_convertvector(place, Ints);
  const Floats fraction = place - __builtin_convertvector(index, Floats);
  Floats value;
  for (int lane = 0; lane < kLanes; ++lane) {
    const float* entry = &line[static_cast<std::size_t>(index[lane])];
    value[lane] = entry[0] + fraction[lane] * (entry[1] - entry[0]);
  }
  return value;
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

// The blurred step of the neighbouring side that ends this one: 1 on the inner side of it, 0
// beyond.
Floats Cover(const Side& neighbour, const Eigen::Vector2d& origin_px, Floats x, Floats y,
             double blur_px) {
  const Eigen::Vector2f outward = neighbour.outward.cast<float>();
  const auto offset = static_cast<float>((neighbour.middle_px - origin_px).dot(neighbour.outward));
  const Floats z = (offset - x * outward.x() - y * outward.y()) * static_cast<float>(1 / blur_px);
  constexpr float kReach = 3.5f;
  return -MaxLane(-z) > kReach ? AllLanes(1.0) : NormalAt(z).distribution;
}

Floats At(const LinearInS& line, Floats s) {
  return static_cast<float>(line.middle) + static_cast<float>(line.slope) * s;
}

// Fills in everything that follows from the place of the samples; x and y are relative to the
// middle of the side.
void FillSamples(const SideModel& model, Floats x, Floats y, EdgeSampleGroup* samples) {
  const Side& side = model.side;
  const Eigen::Vector2f along = (side.along / side.half_length_px).cast<float>();
  const Eigen::Vector2f outward = side.outward.cast<float>();
  samples->s = x * along.x() + y * along.y();
  samples->distance_px = x * outward.x() + y * outward.y();
  samples->cover = Cover(model.previous, side.middle_px, x, y, model.blur_px) *
                   Cover(model.next, side.middle_px, x, y, model.blur_px);
  const Floats s = samples->s;
  samples->inner = Max(
      Floats{}, LookUp(model.inner_gray, At(model.inner.u, s)) - static_cast<float>(model.dark));
  samples->outer = Min(
      Floats{}, LookUp(model.outer_gray, At(model.outer.u, s)) - static_cast<float>(model.light));
  samples->inner_depth_px = At(model.inner.depth_px, s);
  samples->outer_depth_px = At(model.outer.depth_px, s);
}

}  // namespace

SideModel MakeSideModel(const cv::Mat& gray, const QuadCorners& quad, int side_idx, int num_cells,
                        double blur_px) {
  const auto turned = [&](int turns) {
    QuadCorners result = quad;
    std::rotate(result.begin(), result.begin() + turns % kNumCorners, result.end());
    return result;
  };
  const QuadCorners own = turned(side_idx);
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

VELAMAP_CLONE_FOR_AVX2 void SampleSide(const cv::Mat& gray, const SideModel& model, double band_px,
                                       int max_samples, EdgeSamples* samples) {
  const Side& side = model.side;
  const double margin_px =
      std::clamp(0.24 * side.half_length_px, model.blur_px, 2.5 * model.blur_px);
  const double reach_px = side.half_length_px - margin_px;
  samples->count = 0;
  if (!(reach_px > 0)) return;
  const int major = std::abs(side.along.x()) >= std::abs(side.along.y()) ? 0 : 1;
  const int minor = 1 - major;
  const double major_reach =
      reach_px * std::abs(side.along[major]) + band_px * std::abs(side.outward[major]);
  const double minor_reach = band_px / std::abs(side.outward[minor]);
  const int stride =
      static_cast<int>(std::ceil(4 * reach_px * band_px / std::min(max_samples, kMaxEdgeSamples)));
  const int major_size = major == 0 ? gray.cols : gray.rows;
  const int minor_size = major == 0 ? gray.rows : gray.cols;
  int first = std::max(0, static_cast<int>(std::ceil(side.middle_px[major] - major_reach)));
  // Begins at a multiple of the stride, so that the choice of lines does not depend on the band.
  first += (stride - first % stride) % stride;
  const int last =
      std::min(major_size - 1, static_cast<int>(std::floor(side.middle_px[major] + major_reach)));
  Floats x{}, y{};
  const auto fill = [&] {
    FillSamples(model, x, y,
                &samples->groups[static_cast<std::size_t>((samples->count - 1) / kLanes)]);
  };
  for (int i = first; i <= last; i += stride) {
    const double center =
        side.middle_px[minor] + (i - side.middle_px[major]) * side.along[minor] / side.along[major];
    const int begin = std::max(0, static_cast<int>(std::ceil(center - minor_reach)));
    const int end = std::min(minor_size - 1, static_cast<int>(std::floor(center + minor_reach)));
    for (int j = begin; j <= end; ++j) {
      Eigen::Vector2d x_px;
      x_px[major] = i;
      x_px[minor] = j;
      const Eigen::Vector2d from_middle = x_px - side.middle_px;
      const double along_px = from_middle.dot(side.along);
      if (std::abs(along_px) > reach_px || samples->count == kMaxEdgeSamples) continue;
      const int lane = samples->count % kLanes;
      Floats& values = samples->groups[static_cast<std::size_t>(samples->count++ / kLanes)].gray;
      // Copies of this pixel complete the last group.
      for (int k = lane; k < kLanes; ++k) {
        x[k] = static_cast<float>(from_middle.x());
        y[k] = static_cast<float>(from_middle.y());
        values[k] = major == 0 ? gray.at<std::uint8_t>(j, i) : gray.at<std::uint8_t>(i, j);
      }
      if (lane == kLanes - 1) fill();
    }
  }
  if (samples->count % kLanes != 0) fill();
}

EdgePrior MakeEdgePrior(const SideModel& model) {
  const double contrast = model.light - model.dark;
  const double half_length = model.side.half_length_px;
  using E = EdgeParameters;
  EdgePrior prior;
  E& mean = prior.mean;
  mean[E::kBlur] = model.blur_px;
  mean[E::kDark] = model.dark;
  mean[E::kLight] = model.light;
  mean[E::kInnerGain] = mean[E::kOuterGain] = 1.0;
  E& sigma = prior.sigma;
  sigma[E::kOffset] = sigma[E::kSlope] = 1e3;
  sigma[E::kBend] = 2e-3 * half_length + 5e-4 * half_length * half_length;
  sigma[E::kBlur] = 0.5;
  sigma[E::kDark] = sigma[E::kLight] = 1e3;
  sigma[E::kDarkSlope] = sigma[E::kLightSlope] = 0.1 * contrast;
  sigma[E::kInnerGain] = sigma[E::kOuterGain] = 0.3;
  return prior;
}

}  // namespace velamap
