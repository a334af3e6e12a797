// A pattern of square cells blurred by a Gaussian, at four places at once, with derivatives.
//
// The blurred pattern is separable: sum_ij lightness_ij a_i(u) b_j(v), where a_i is the unit step
// of column i blurred. Places and blurs are in cells, (0, 0) at the first cell's outer corner. The
// pattern of n cells has kRing more around it; the outermost reach to infinity.

#pragma once

#include <array>

#include <Eigen/Core>

#include "importer/float_lanes.h"

namespace velamap {

constexpr int kRing = 2;             // quiet zone, then its surroundings
constexpr int kMaxRingedCells = 32;  // along a side, with the rings

// Of column i, row j at (j + kRing, i + kRing); 0 for dark, 1 for light.
using Lightness = Eigen::Matrix<float, kMaxRingedCells, kMaxRingedCells, Eigen::RowMajor>;

// How the blurred columns (or rows) share four places, in cells: for each, weights of the cells
// first ... first + count - 1, counted with the rings, and their derivatives by the place and by
// the blur.
struct Shares {
  int count = 0;
  Ints first;
  Floats blur;
  std::array<Floats, kMaxRingedCells> value, by_x, by_blur;
};

void ComputeShares(Floats x, Floats blur, int num_cells, Shares* shares);

// Whether the blur of one of the places reaches one of the outermost `num_rings` rings.
bool Reaches(int num_rings, const Shares& shares, int num_cells);

// Lightness of the blurred pattern and its derivatives by u, v and the two blurs (all in cells).
struct Blended {
  Floats value{}, by_u{}, by_v{}, by_blur_u{}, by_blur_v{};
  Floats by_u_v{}, by_uu_vv{};
};

Blended Blend(const Lightness& lightness, const Shares& u, const Shares& v);

// The value alone.
Floats BlendValue(const Lightness& lightness, const Shares& u, const Shares& v);

// *b += factor * a.
void Add(Floats factor, const Blended& a, Blended* b);

// An oblique view makes the blur in u and v correlated: applies exp(covariance d/du d/dv) to the
// value, to second order.
void AddCorrelation(Floats covariance, Blended* blended);

}  // namespace velamap
