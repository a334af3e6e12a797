#include "importer/pattern/pattern_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "importer/pattern/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

// Completes the last group with copies of its first pixel.
inline void FillUp(ChosenPixels* pixels) {
  for (int lane = pixels->count % kLanes; lane > 0 && lane < kLanes; ++lane) {
    ChosenPixels::Group& last = pixels->groups.back();
    last.x[lane] = last.x[0];
    last.y[lane] = last.y[0];
    last.gray[lane] = last.gray[0];
    last.root_weight[lane] = last.root_weight[0];
  }
}

// Calls take(group, covered) for every group of pixels of the box, in rows; `covered` is -1 for the
// pixels that the model covers and that count.
template <typename Take>
inline void ForEachGroup(const PatternProblem& problem, const PatternPicture& picture,
                         const Take& take) {
  const cv::Rect& box = problem.box;
  const Eigen::Vector2d& center = problem.model.center_px;
  for (int row = box.y; row < box.y + box.height; ++row) {
    const int patch_row = row - problem.patch.origin_px.y;
    const float* values = problem.patch.values.ptr<float>(patch_row);
    const std::uint8_t* left_out = problem.patch.is_left_out.empty()
                                       ? nullptr
                                       : problem.patch.is_left_out.ptr<std::uint8_t>(patch_row);
    const Floats y = AllLanes(row - center.y());
    for (int begin = box.x; begin < box.x + box.width; begin += kLanes) {
      ChosenPixels::Group group{static_cast<float>(begin - center.x()) + LaneIndex(), y, {}, {}};
      Ints covered = picture.Covers(group.x, group.y);
      for (int lane = 0; lane < kLanes; ++lane) {
        const int column = begin + lane - problem.patch.origin_px.x;
        if (begin + lane >= box.x + box.width || (left_out && left_out[column])) covered[lane] = 0;
        if (covered[lane]) group.gray[lane] = values[column];
      }
      take(group, covered);
    }
  }
}

}  // namespace

VELAMAP_CLONE_FOR_AVX2 ChosenPixels ChoosePixels(const PatternProblem& problem,
                                                 const P::Vector& parameters, int max_pixels) {
  constexpr int kPartOfOthers = 5;  // one in so many pixels
  const PatternPicture picture(problem.model, parameters);
  const double area_px = 0.8 * problem.model.diagonal_px * problem.model.diagonal_px;
  const bool takes_all = area_px <= max_pixels;
  const auto reach_px = static_cast<float>(1 + 2 * parameters.segment<2>(P::kBlurU).maxCoeff());
  ChosenPixels near, others;
  const auto add = [](const ChosenPixels::Group& group, int lane, ChosenPixels* pixels) {
    const int place = pixels->count++ % kLanes;
    if (place == 0) pixels->groups.emplace_back();
    ChosenPixels::Group& last = pixels->groups.back();
    last.x[place] = group.x[lane];
    last.y[place] = group.y[lane];
    last.gray[place] = group.gray[lane];
    last.root_weight[place] = group.root_weight[lane];
  };
  const double corner_weight = problem.model.outline_corner_weight;
  ForEachGroup(problem, picture, [&](ChosenPixels::Group group, Ints covered) {
    if (MinLane(covered) == 0) return;
    group.root_weight = AllLanes(1.0);
    if (corner_weight < 1) {
      const Ints is_at_corner = picture.IsAtOutlineCorner(group.x, group.y);
      if (corner_weight == 0) covered &= ~is_at_corner;
      group.root_weight = is_at_corner ? AllLanes(std::sqrt(corner_weight)) : group.root_weight;
    }
    const Ints is_near = takes_all ? covered : picture.IsNearEdge(group.x, group.y, reach_px);
    for (int lane = 0; lane < kLanes; ++lane) {
      if (covered[lane]) add(group, lane, is_near[lane] ? &near : &others);
    }
  });
  if (takes_all) {
    FillUp(&near);
    return near;
  }
  ChosenPixels chosen;
  const auto take_every = [&](double step, const ChosenPixels& pixels) {
    for (double i = 0.5 * step; i < pixels.count; i += std::max(1.0, step)) {
      const int idx = static_cast<int>(i);
      add(pixels.groups[static_cast<std::size_t>(idx / kLanes)], idx % kLanes, &chosen);
    }
  };
  take_every(static_cast<double>(near.count) / max_pixels, near);
  take_every(kPartOfOthers * static_cast<double>(others.count) / max_pixels, others);
  FillUp(&chosen);
  return chosen;
}

VELAMAP_CLONE_FOR_AVX2 std::vector<PixelResidual> Residuals(const PatternProblem& problem,
                                                            const P::Vector& parameters,
                                                            const ChosenPixels& pixels) {
  const PatternPicture picture(problem.model, parameters);
  const Eigen::Vector2d origin =
      problem.model.center_px -
      Eigen::Vector2d(problem.patch.origin_px.x, problem.patch.origin_px.y);
  std::vector<PixelResidual> residuals;
  residuals.reserve(static_cast<std::size_t>(pixels.count));
  PatternPixels modelled;
  for (const ChosenPixels::Group& group : pixels.groups) {
    picture.At(group.x, group.y, &modelled);
    const Floats squared_slope = SquaredSlope(modelled.jacobian);
    for (int lane = 0; lane < kLanes && static_cast<int>(residuals.size()) < pixels.count; ++lane) {
      residuals.push_back({cv::Point(static_cast<int>(std::lround(origin.x() + group.x[lane])),
                                     static_cast<int>(std::lround(origin.y() + group.y[lane]))),
                           std::abs(static_cast<double>(modelled.gray[lane] - group.gray[lane])),
                           std::sqrt(static_cast<double>(squared_slope[lane]))});
    }
  }
  return residuals;
}

}  // namespace velamap
