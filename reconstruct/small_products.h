// Products of matrices that are too small for Eigen's kernels: these split them into panels and
// copy, which takes longer than the product. Private to this room.

#pragma once

#include <Eigen/Core>

namespace velamap {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// out += a^T b, or -= with kSign -1, for row-major matrices with as many rows; kCols is the width
// of b, known to the compiler. Rows of b and of out are so far apart as the strides say.
template <int kCols, int kSign = 1>
void AddTransposedProduct(const RowMajorMatrix& a, const double* b, Eigen::Index b_stride,
                          double* out, Eigen::Index out_stride) {
  using Row = Eigen::Matrix<double, 1, kCols>;
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    Eigen::Map<Row> out_row(out + i * out_stride);
    Row sum = out_row;
    for (Eigen::Index row = 0; row < a.rows(); ++row) {
      sum += (kSign * a(row, i)) * Eigen::Map<const Row>(b + row * b_stride);
    }
    out_row = sum;
  }
}

// out += a b, or -= with kSign -1; as above.
template <int kCols, int kSign = 1>
void AddProduct(const RowMajorMatrix& a, const double* b, Eigen::Index b_stride, double* out,
                Eigen::Index out_stride) {
  using Row = Eigen::Matrix<double, 1, kCols>;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    Eigen::Map<Row> out_row(out + i * out_stride);
    Row sum = out_row;
    for (Eigen::Index k = 0; k < a.cols(); ++k) {
      sum += (kSign * a(i, k)) * Eigen::Map<const Row>(b + k * b_stride);
    }
    out_row = sum;
  }
}

}  // namespace velamap
