// A pattern of square cells blurred by a Gaussian, at one place, with derivatives.
//
// The blurred pattern is separable: sum_ij lightness_ij a_i(u) b_j(v), where a_i is the unit step
// of column i blurred. Places and blurs are in cells, (0, 0) at the first cell's outer corner. The
// pattern of n cells has kRing more around it; the outermost reach to infinity.

#pragma once

#include <array>

#include <Eigen/Core>

namespace velamap {

constexpr int kRing = 2;             // quiet zone, then its surroundings
constexpr int kMaxRingedCells = 32;  // along a side, with the rings

// Of column i, row j at (j + kRing, i + kRing); 0 for dark, 1 for light.
using Lightness = Eigen::Matrix<double, kMaxRingedCells, kMaxRingedCells, Eigen::RowMajor>;

// How the blurred columns (or rows) share a place x, in cells: weights of the cells first ... first
// + count - 1, counted with the rings, and their derivatives by x and by the blur.
struct Shares {
  int first = 0, count = 0;
  double blur = 0.0;
  std::array<double, kMaxRingedCells> value, by_x, by_blur;
};

void ComputeShares(double x, double blur, int num_cells, Shares* shares);

// Whether the blur of a place reaches one of the outermost `num_rings` rings.
bool Reaches(int num_rings, const Shares& shares, int num_cells);

// Lightness of the blurred pattern and its derivatives by u, v and the two blurs (all in cells).
struct Blended {
  double value = 0.0, by_u = 0.0, by_v = 0.0, by_blur_u = 0.0, by_blur_v = 0.0;
  double by_u_v = 0.0, by_uu_vv = 0.0;
};

Blended Blend(const Lightness& lightness, const Shares& u, const Shares& v);

// The value alone.
double BlendValue(const Lightness& lightness, const Shares& u, const Shares& v);

// *b += factor * a.
void Add(double factor, const Blended& a, Blended* b);

// An oblique view makes the blur in u and v correlated: applies exp(covariance d/du d/dv) to the
// value, to second order.
void AddCorrelation(double covariance, Blended* blended);

}  // namespace velamap
