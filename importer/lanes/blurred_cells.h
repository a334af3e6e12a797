// A pattern of square cells blurred by a Gaussian, at a group of places at once, with derivatives.
//
// The blurred pattern is separable: sum_ij lightness_ij a_i(u) b_j(v), where a_i is the blurred
// unit step of column i. Places and blurs are in cells, with (0, 0) at the outer corner of the
// first cell. kRing more cells surround the n cells of the pattern; the outermost extend to
// infinity.

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include <Eigen/Core>

#include "importer/lanes/normal_lanes.h"

namespace velamap {

constexpr int kRing = 2;             // quiet zone, then its surroundings
constexpr int kMaxRingedCells = 32;  // along a side, with the rings

// The cell of column i and row j is at (j + kRing, i + kRing).
using Lightness = Eigen::Matrix<float, kMaxRingedCells, kMaxRingedCells, Eigen::RowMajor>;

// Bit i + kRing of the number at j + kRing is set where the cell of column i and row j is light.
using LightCells = std::array<std::int32_t, kMaxRingedCells>;
static_assert(kMaxRingedCells <= 32);

// The weights of the blurred columns (or rows) at a group of places: for each place those of the
// cells first ... first + count - 1, counted with the rings, and their derivatives with respect to
// the place and the blur.
struct CellWeights {
  int count = 0;
  Ints first;
  int least_first = 0, largest_first = 0;  // of the places
  Floats blur;
  FloatsArray<kMaxRingedCells> value, by_x, by_blur;
};

// Where the edges around the black square lie along one axis, in cells.
struct OuterEdges {
  float margin_low = 1.0f, margin_high = 1.0f;  // widths of the quiet zone
  Floats outline_shift{};                       // of the square's outline, outwards
};

// Computes the weights of the blurred columns (or rows) at the places `x` with the widths `blur`,
// both in cells. Places that are not finite give weights of cells inside the pattern.
inline void ComputeCellWeights(Floats x, Floats blur, int num_cells, const OuterEdges& outer,
                               CellWeights* weights) {
  constexpr float kReach = 3.3f;  // sigmas
  // Edge k lies between the ringed cells k and k + 1. Edges are one cell apart, except the first
  // and the last, where the quiet zone ends, and the outline of the square.
  const int all_edges = num_cells + 2 * kRing - 1;
  const Floats place = x + static_cast<float>(kRing - 1);
  // A diverging fit makes these infinite or NaN; the limits keep the cells inside the pattern.
  const Floats limit = AllLanes(2 * kMaxRingedCells);
  const Floats reach = Min(kReach * blur, limit);
  // The same number of edges for all places; edges out of reach have no effect.
  const int num_edges = std::min(static_cast<int>(2 * MaxLane(reach)) + 2, all_edges);
  Ints low = Floor(Max(Min(place, limit), -limit) - reach) + 1;
  // A narrow quiet zone moves edge 0 inwards by up to one cell, so it may act wherever edge 1 is in
  // reach. At the other end the spare edge of num_edges covers this.
  low = low < 2 ? Ints{} : low;
  low = low > all_edges - num_edges ? Ints{} + (all_edges - num_edges) : low;
  weights->first = low;
  weights->least_first = MinLane(low);
  weights->largest_first = MaxLane(low);
  weights->blur = blur;
  weights->count = num_edges + 1;
  const Floats inverse_blur = 1.0f / blur;
  const Floats from_low = place - __builtin_convertvector(low, Floats);
  // Each weight is the difference between the steps of two neighbouring edges.
  Floats distribution = AllLanes(1.0), density{}, moment{};
  for (int i = 0; i < num_edges; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const Ints edge = low + i;
    const Floats none{};
    const Floats forwards = (edge == 0 ? AllLanes(1 - outer.margin_low) : none) -
                            (edge == kRing - 1 ? outer.outline_shift : none) +
                            (edge == all_edges - kRing ? outer.outline_shift : none) -
                            (edge == all_edges - 1 ? AllLanes(1 - outer.margin_high) : none);
    const Floats z = (from_low - static_cast<float>(i) - forwards) * inverse_blur;
    const NormalLanes normal = NormalAt(z);
    const Floats next_density = normal.density * inverse_blur;
    const Floats next_moment = -z * next_density;
    weights->value[index] = distribution - normal.distribution;
    weights->by_x[index] = density - next_density;
    weights->by_blur[index] = moment - next_moment;
    distribution = normal.distribution;
    density = next_density;
    moment = next_moment;
  }
  const auto last = static_cast<std::size_t>(num_edges);
  weights->value[last] = distribution;
  weights->by_x[last] = density;
  weights->by_blur[last] = moment;
}

// Whether the blur of one of the places reaches one of the outermost `num_rings` rings.
inline bool Reaches(int num_rings, const CellWeights& weights, int num_cells) {
  return weights.least_first < num_rings ||
         weights.largest_first + weights.count > num_cells + 2 * kRing - num_rings;
}

// Lightness of the blurred pattern and its derivatives with respect to u, v and the two blurs (all
// in cells).
struct Blended {
  Floats value{}, by_u{}, by_v{}, by_blur_u{}, by_blur_v{};
  Floats by_u_v{}, by_uu_vv{};  // d2/du dv and d4/du2 dv2, for AddCorrelation()
};

namespace internal {

// The contribution of one row, or of all columns, to a group of places, and its derivatives with
// respect to the place and the blur.
struct Sums {
  Floats value{}, by_x{}, by_blur{};
};

// Adds the i-th column with a weight at the places; `weigh` selects how much of it counts.
template <typename Weigh>
void AddColumn(const CellWeights& weights, int i, const Weigh& weigh, Sums* sums) {
  const auto index = static_cast<std::size_t>(i);
  sums->value += weigh(weights.value[index]);
  sums->by_x += weigh(weights.by_x[index]);
  sums->by_blur += weigh(weights.by_blur[index]);
}

// `row(j)` returns the Sums of the j-th row with a weight at the places.
template <typename Row>
Blended BlendRows(const CellWeights& u, const CellWeights& v, const Row& row) {
  Blended sum;
  Floats by_blur_u_v{};
  for (int j = 0; j < v.count; ++j) {
    const Sums columns = row(j);
    const auto index = static_cast<std::size_t>(j);
    sum.value += columns.value * v.value[index];
    sum.by_u += columns.by_x * v.value[index];
    sum.by_blur_u += columns.by_blur * v.value[index];
    sum.by_v += columns.value * v.by_x[index];
    sum.by_blur_v += columns.value * v.by_blur[index];
    sum.by_u_v += columns.by_x * v.by_x[index];
    by_blur_u_v += columns.by_blur * v.by_blur[index];
  }
  sum.by_uu_vv = by_blur_u_v / (u.blur * v.blur);  // for a Gaussian, d/dblur = blur d2/dx2
  return sum;
}

// x where `is_chosen` is -1, zero where it is zero.
inline Floats Choose(Ints is_chosen, Floats x) {
  Ints bits;
  std::memcpy(&bits, &x, sizeof(bits));
  bits &= is_chosen;
  std::memcpy(&x, &bits, sizeof(x));
  return x;
}

// Sums over the columns of the black square.
inline Sums WithinSquare(const CellWeights& weights, int num_cells) {
  Sums sums;
  for (int i = 0; i < weights.count; ++i) {
    const Ints column = weights.first + i;
    const Ints is_within = (column >= kRing) & (column < num_cells + kRing);
    AddColumn(
        weights, i, [&](Floats weight) { return Choose(is_within, weight); }, &sums);
  }
  return sums;
}

}  // namespace internal

// Blurs a pattern whose cells are light (1) or dark (0).
inline Blended BlendLight(const LightCells& light, const CellWeights& u, const CellWeights& v) {
  return internal::BlendRows(u, v, [&](int j) {
    Ints columns;
    for (int lane = 0; lane < kLanes; ++lane) {
      columns[lane] = light[static_cast<std::size_t>(v.first[lane] + j)];
    }
    columns >>= u.first;
    internal::Sums sums;
    for (int i = 0; i < u.count; ++i) {
      const Ints is_light = -(columns >> i & 1);
      internal::AddColumn(
          u, i, [&](Floats weight) { return internal::Choose(is_light, weight); }, &sums);
    }
    return sums;
  });
}

// Blurs a dark square on light ground.
inline Blended BlendGround(const CellWeights& u, const CellWeights& v, int num_cells) {
  const internal::Sums a = internal::WithinSquare(u, num_cells);
  const internal::Sums b = internal::WithinSquare(v, num_cells);
  return {1.0f - a.value * b.value,
          -a.by_x * b.value,
          -a.value * b.by_x,
          -a.by_blur * b.value,
          -a.value * b.by_blur,
          -a.by_x * b.by_x,
          -a.by_blur * b.by_blur / (u.blur * v.blur)};
}

// The blurred surroundings of the quiet zone, and their derivatives with respect to its widths:
// before the first column, after the last column, before the first row, after the last row.
struct BlendedSurroundings {
  Blended blended;
  FloatsArray<4> by_margin{};
};

// Blurs a pattern that is zero except in the outermost ring, the surroundings of the quiet zone.
inline BlendedSurroundings BlendOutermost(const Lightness& lightness, const CellWeights& u,
                                          const CellWeights& v, int num_cells) {
  std::array<const float*, kLanes> corners;
  for (int lane = 0; lane < kLanes; ++lane) {
    corners[static_cast<std::size_t>(lane)] =
        lightness.data() + v.first[lane] * kMaxRingedCells + u.first[lane];
  }
  const int last = num_cells + 2 * kRing - 1;
  const auto is_outermost = [&](const CellWeights& weights, int i) {
    return weights.least_first + i == 0 || weights.largest_first + i == last;
  };
  BlendedSurroundings surroundings;
  surroundings.blended = internal::BlendRows(u, v, [&](int j) {
    const bool is_outermost_row = is_outermost(v, j);
    internal::Sums sums;
    Floats left{}, right{};
    for (int i = 0; i < u.count; ++i) {
      if (!is_outermost_row && !is_outermost(u, i)) continue;
      Floats cells;
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        cells[lane] = corners[lane][j * kMaxRingedCells + i];
      }
      internal::AddColumn(
          u, i, [&](Floats weight) { return cells * weight; }, &sums);
      const Floats by_x = cells * u.by_x[static_cast<std::size_t>(i)];
      left += internal::Choose(u.first + i == 0, by_x);
      right -= internal::Choose(u.first + i == last, by_x);
    }
    const auto index = static_cast<std::size_t>(j);
    surroundings.by_margin[0] += left * v.value[index];
    surroundings.by_margin[1] += right * v.value[index];
    const Floats by_y = sums.value * v.by_x[index];
    surroundings.by_margin[2] += internal::Choose(v.first + j == 0, by_y);
    surroundings.by_margin[3] -= internal::Choose(v.first + j == last, by_y);
    return sums;
  });
  return surroundings;
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
