// Sums of products in groups of four doubles, for matrices in rows: the vector extension of GCC and
// Clang. Eigen is compiled for processors without AVX; a function that is built on these can be
// compiled for those with it too. Private to this room.

#pragma once

#include <cstddef>

#include <Eigen/Core>

// Before a function that is only called where HasAvx2(). It has everything inlined that it calls.
#if defined(__x86_64__) && defined(__GNUC__)
#define VELAMAP_WITH_AVX2 __attribute__((target("avx2,fma"), flatten))
#else
#define VELAMAP_WITH_AVX2
#endif

namespace velamap {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline bool HasAvx2() {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

// At any address.
template <int kCount>
struct DoubleLanes {
  using Type
      __attribute__((vector_size(kCount * sizeof(double)), aligned(sizeof(double)), may_alias)) =
          double;
};
template <>
struct DoubleLanes<1> {
  using Type = double;
};

// out(i, :) += kSign sum over k of a(k, i) b(k, :) for kRows columns i of a and kVectors groups of
// kWidth columns of b. Steps: from a(k, i) to a(k, i + 1) and to a(k + 1, i), from row to row of b
// and of out.
template <int kRows, int kWidth, int kVectors, int kSign>
inline void AddTile(const double* a, std::ptrdiff_t a_step, std::ptrdiff_t a_stride,
                    const double* b, std::ptrdiff_t b_stride, std::ptrdiff_t count, double* out,
                    std::ptrdiff_t out_stride) {
  using Lanes = typename DoubleLanes<kWidth>::Type;
  Lanes sums[kRows][kVectors];
  for (int i = 0; i < kRows; ++i) {
    for (int v = 0; v < kVectors; ++v) {
      sums[i][v] = *reinterpret_cast<const Lanes*>(out + i * out_stride + v * kWidth);
    }
  }
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const double* a_k = a + k * a_stride;
    const double* b_k = b + k * b_stride;
    for (int i = 0; i < kRows; ++i) {
      const double factor = a_k[i * a_step];
      for (int v = 0; v < kVectors; ++v) {
        const Lanes product = factor * *reinterpret_cast<const Lanes*>(b_k + v * kWidth);
        sums[i][v] = kSign < 0 ? sums[i][v] - product : sums[i][v] + product;
      }
    }
  }
  for (int i = 0; i < kRows; ++i) {
    for (int v = 0; v < kVectors; ++v) {
      *reinterpret_cast<Lanes*>(out + i * out_stride + v * kWidth) = sums[i][v];
    }
  }
}

// The same for num_rows rows of out and kCols columns, at most kMaxWidth of them in a group: wider
// ones than the processor has would go through memory.
template <int kCols, int kSign, int kMaxWidth>
inline void AddTiles(const double* a, std::ptrdiff_t a_step, std::ptrdiff_t a_stride,
                     std::ptrdiff_t num_rows, const double* b, std::ptrdiff_t b_stride,
                     std::ptrdiff_t count, double* out, std::ptrdiff_t out_stride) {
  constexpr int kWidth = kCols >= 4 && kMaxWidth == 4 ? 4 : kCols >= 2 ? 2 : 1;
  constexpr int kVectors = kCols / kWidth, kDone = kVectors * kWidth, kRows = kMaxWidth;
  std::ptrdiff_t i = 0;
  for (; i + kRows <= num_rows; i += kRows) {
    AddTile<kRows, kWidth, kVectors, kSign>(a + i * a_step, a_step, a_stride, b, b_stride, count,
                                            out + i * out_stride, out_stride);
  }
  for (; i < num_rows; ++i) {
    AddTile<1, kWidth, kVectors, kSign>(a + i * a_step, a_step, a_stride, b, b_stride, count,
                                        out + i * out_stride, out_stride);
  }
  if constexpr (kDone < kCols) {
    AddTiles<kCols - kDone, kSign, kMaxWidth>(a, a_step, a_stride, num_rows, b + kDone, b_stride,
                                              count, out + kDone, out_stride);
  }
}

template <int kCols, int kSign>
VELAMAP_WITH_AVX2 void AddTilesWithAvx2(const double* a, std::ptrdiff_t a_step,
                                        std::ptrdiff_t a_stride, std::ptrdiff_t num_rows,
                                        const double* b, std::ptrdiff_t b_stride,
                                        std::ptrdiff_t count, double* out,
                                        std::ptrdiff_t out_stride) {
  AddTiles<kCols, kSign, 4>(a, a_step, a_stride, num_rows, b, b_stride, count, out, out_stride);
}

// out += a^T b, or -= with kSign -1, for matrices that are too small for Eigen's kernels: these
// split them into panels and copy, which takes longer than the product. kCols is the width of b;
// rows of b and out are so far apart as the strides say.
template <int kCols, int kSign = 1, typename Matrix>
void AddTransposedProduct(const Matrix& a, const double* b, std::ptrdiff_t b_stride, double* out,
                          std::ptrdiff_t out_stride) {
  static_assert(Matrix::IsRowMajor);
  const auto add = HasAvx2() ? AddTilesWithAvx2<kCols, kSign> : AddTiles<kCols, kSign, 2>;
  add(a.data(), 1, a.cols(), a.cols(), b, b_stride, a.rows(), out, out_stride);
}

// out += a b, or -=; as above.
template <int kCols, int kSign = 1, typename Matrix>
void AddProduct(const Matrix& a, const double* b, std::ptrdiff_t b_stride, double* out,
                std::ptrdiff_t out_stride) {
  static_assert(Matrix::IsRowMajor);
  const auto add = HasAvx2() ? AddTilesWithAvx2<kCols, kSign> : AddTiles<kCols, kSign, 2>;
  add(a.data(), a.cols(), 1, a.rows(), b, b_stride, a.cols(), out, out_stride);
}

}  // namespace velamap
