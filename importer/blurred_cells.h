// A pattern of square cells blurred by a Gaussian, at a group of places at once, with derivatives.
//
// The blurred pattern is separable: sum_ij lightness_ij a_i(u) b_j(v), where a_i is the unit step
// of column i blurred. Places and blurs are in cells, (0, 0) at the first cell's outer corner. The
// pattern of n cells has kRing more around it; the outermost reach to infinity.

#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

#include "importer/normal_lanes.h"

namespace velamap {

constexpr int kRing = 2;             // quiet zone, then its surroundings
constexpr int kMaxRingedCells = 32;  // along a side, with the rings

// Of column i, row j at (j + kRing, i + kRing); 0 for dark, 1 for light.
using Lightness = Eigen::Matrix<float, kMaxRingedCells, kMaxRingedCells, Eigen::RowMajor>;

// How the blurred columns (or rows) share a group of places, in cells: for each, weights of the
// cells first ... first + count - 1, counted with the rings, and their derivatives by the place and
// by the blur.
struct Shares {
  int count = 0;
  Ints first;
  Floats blur;
  FloatsArray<kMaxRingedCells> value, by_x, by_blur;
};

inline void ComputeShares(Floats x, Floats blur, int num_cells, Shares* shares) {
  constexpr float kReach = 3.3f;  // sigmas
  // Edge k lies between the ringed cells k and k + 1.
  const int all_edges = num_cells + 2 * kRing - 1;
  const Floats place = x + static_cast<float>(kRing - 1);
  // Where a fit runs away these need not be finite: the limits keep the cells inside the pattern.
  const Floats limit = AllLanes(2 * kMaxRingedCells);
  const Floats reach = Min(kReach * blur, limit);
  // As many edges for each of the places; those out of reach do no harm.
  const int num_edges = std::min(static_cast<int>(2 * MaxLane(reach)) + 1, all_edges);
  Ints low = Floor(Max(Min(place, limit), -limit) - reach) + 1;
  low = low < 0 ? Ints{} : low;
  low = low > all_edges - num_edges ? Ints{} + (all_edges - num_edges) : low;
  shares->first = low;
  shares->blur = blur;
  shares->count = num_edges + 1;
  const Floats inverse_blur = 1.0f / blur;
  const Floats from_low = place - __builtin_convertvector(low, Floats);
  // What one edge leaves, the next takes.
  Floats distribution = AllLanes(1.0), density{}, moment{};
  for (int i = 0; i < num_edges; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const Floats z = (from_low - static_cast<float>(i)) * inverse_blur;
    const NormalLanes normal = NormalAt(z);
    const Floats next_density = normal.density * inverse_blur;
    const Floats next_moment = -z * next_density;
    shares->value[index] = distribution - normal.distribution;
    shares->by_x[index] = density - next_density;
    shares->by_blur[index] = moment - next_moment;
    distribution = normal.distribution;
    density = next_density;
    moment = next_moment;
  }
  const auto last = static_cast<std::size_t>(num_edges);
  shares->value[last] = distribution;
  shares->by_x[last] = density;
  shares->by_blur[last] = moment;
}

// Whether the blur of one of the places reaches one of the outermost `num_rings` rings.
inline bool Reaches(int num_rings, const Shares& shares, int num_cells) {
  int low = shares.first[0], high = low;
  for (int lane = 1; lane < kLanes; ++lane) {
    low = std::min(low, static_cast<int>(shares.first[lane]));
    high = std::max(high, static_cast<int>(shares.first[lane]));
  }
  return low < num_rings || high + shares.count > num_cells + 2 * kRing - num_rings;
}

// Lightness of the blurred pattern and its derivatives by u, v and the two blurs (all in cells).
struct Blended {
  Floats value{}, by_u{}, by_v{}, by_blur_u{}, by_blur_v{};
  Floats by_u_v{}, by_uu_vv{};
};

namespace internal {

// Of column `column` to the right of the first, in row `row` below the first, for each place.
inline Floats Gather(const std::array<const float*, kLanes>& corners, int row, int column) {
  const int offset = row * kMaxRingedCells + column;
  Floats cells;
  for (std::size_t lane = 0; lane < kLanes; ++lane) cells[lane] = corners[lane][offset];
  return cells;
}

inline std::array<const float*, kLanes> FirstCells(const Lightness& lightness, const Shares& u,
                                                   const Shares& v) {
  std::array<const float*, kLanes> corners;
  for (int lane = 0; lane < kLanes; ++lane) {
    corners[static_cast<std::size_t>(lane)] =
        lightness.data() + v.first[lane] * kMaxRingedCells + u.first[lane];
  }
  return corners;
}

}  // namespace internal

inline Blended Blend(const Lightness& lightness, const Shares& u, const Shares& v) {
  const std::array<const float*, kLanes> corners = internal::FirstCells(lightness, u, v);
  Blended sum;
  Floats by_blur_u_v{};
  for (int j = 0; j < v.count; ++j) {
    Floats value{}, by_u{}, by_blur_u{};
    for (int i = 0; i < u.count; ++i) {
      const auto index = static_cast<std::size_t>(i);
      const Floats cell = internal::Gather(corners, j, i);
      value += cell * u.value[index];
      by_u += cell * u.by_x[index];
      by_blur_u += cell * u.by_blur[index];
    }
    const auto index = static_cast<std::size_t>(j);
    sum.value += value * v.value[index];
    sum.by_u += by_u * v.value[index];
    sum.by_blur_u += by_blur_u * v.value[index];
    sum.by_v += value * v.by_x[index];
    sum.by_blur_v += value * v.by_blur[index];
    sum.by_u_v += by_u * v.by_x[index];
    by_blur_u_v += by_blur_u * v.by_blur[index];
  }
  sum.by_uu_vv = by_blur_u_v / (u.blur * v.blur);  // for a Gaussian, d/dblur = blur d2/dx2
  return sum;
}

// The value alone.
inline Floats BlendValue(const Lightness& lightness, const Shares& u, const Shares& v) {
  const std::array<const float*, kLanes> corners = internal::FirstCells(lightness, u, v);
  Floats sum{};
  for (int j = 0; j < v.count; ++j) {
    Floats value{};
    for (int i = 0; i < u.count; ++i) {
      value += internal::Gather(corners, j, i) * u.value[static_cast<std::size_t>(i)];
    }
    sum += value * v.value[static_cast<std::size_t>(j)];
  }
  return sum;
}

// *b += factor * a.
inline void Add(Floats factor, const Blended& a, Blended* b) {
  b->value += factor * a.value;
  b->by_u += factor * a.by_u;
  b->by_v += factor * a.by_v;
  b->by_blur_u += factor * a.by_blur_u;
  b->by_blur_v += factor * a.by_blur_v;
  b->by_u_v += factor * a.by_u_v;
  b->by_uu_vv += factor * a.by_uu_vv;
}

// An oblique view makes the blur in u and v correlated: applies exp(covariance d/du d/dv) to the
// value, to second order.
inline void AddCorrelation(Floats covariance, Blended* blended) {
  blended->value +=
      covariance * blended->by_u_v + 0.5f * covariance * covariance * blended->by_uu_vv;
}

}  // namespace velamap
