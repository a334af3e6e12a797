#include "reconstruct/solve/gram_matrix.h"

#include <gtest/gtest.h>

namespace velamap {
namespace {

// Sizes around the panels' and tiles' edges.
TEST(SubtractGramMatrix, LeavesWhatEigenLeaves) {
  std::srand(1);
  for (const Eigen::Index num_rows : {1, 7, 256, 257, 600}) {
    for (const Eigen::Index size : {1, 3, 4, 12, 13, 23, 25, 36, 50}) {
      const RowMajorMatrix rows = RowMajorMatrix::Random(num_rows, size);
      Eigen::MatrixXd sum = Eigen::MatrixXd::Random(size, size);
      const Eigen::MatrixXd expected = sum - rows.transpose() * rows;
      SubtractGramMatrix(rows, &sum);
      for (Eigen::Index column = 0; column < size; ++column) {
        const Eigen::Index below = size - column;
        EXPECT_LT((sum - expected).col(column).tail(below).norm(), 1e-13 * expected.norm())
            << num_rows << " x " << size << ", column " << column;
      }
    }
  }
}

TEST(SubtractGramMatrix, OfNothingChangesNothing) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Random(5, 5);
  const Eigen::MatrixXd before = sum;
  SubtractGramMatrix(RowMajorMatrix(0, 5), &sum);
  EXPECT_EQ(sum, before);
}

TEST(SolveTransposedOnTheRight, UndoesTheProduct) {
  std::srand(1);
  for (const Eigen::Index size : {1, 5, 12, 13, 24, 50}) {
    Eigen::MatrixXd root = Eigen::MatrixXd::Random(size, size).triangularView<Eigen::Lower>();
    root.diagonal().array() = 3.0 + root.diagonal().array();
    for (const Eigen::Index num_rows : {0, 1, 4, 7}) {
      const RowMajorMatrix expected = RowMajorMatrix::Random(num_rows, size);
      RowMajorMatrix rows = expected * root.transpose();
      SolveTransposedOnTheRight(root, &rows);
      EXPECT_LE((rows - expected).norm(), 1e-11 * expected.norm()) << num_rows << " x " << size;
    }
  }
}

template <int kCols>
void CheckProducts() {
  const RowMajorMatrix a = RowMajorMatrix::Random(9, 7);
  const RowMajorMatrix long_b = RowMajorMatrix::Random(9, kCols);
  const RowMajorMatrix short_b = RowMajorMatrix::Random(7, kCols);
  RowMajorMatrix transposed = RowMajorMatrix::Zero(7, kCols + 2);
  AddTransposedProduct<kCols>(a, long_b.data(), kCols, transposed.data() + 1, kCols + 2);
  EXPECT_LT((transposed.middleCols(1, kCols) - a.transpose() * long_b).norm(), 1e-14) << kCols;
  EXPECT_EQ(transposed.col(0).norm() + transposed.col(kCols + 1).norm(), 0.0) << kCols;
  RowMajorMatrix product = RowMajorMatrix::Zero(9, kCols);
  AddProduct<kCols, -1>(a, short_b.data(), kCols, product.data(), kCols);
  EXPECT_LT((product + a * short_b).norm(), 1e-14) << kCols;
  // As on a processor without AVX2.
  RowMajorMatrix narrow = RowMajorMatrix::Zero(9, kCols);
  AddTiles<kCols, -1, 2>(a.data(), a.cols(), 1, 9, short_b.data(), kCols, 7, narrow.data(), kCols);
  EXPECT_LT((product - narrow).norm(), 1e-14) << kCols;
}

TEST(SmallProducts, AreEigens) {
  CheckProducts<1>();
  CheckProducts<3>();
  CheckProducts<6>();
  CheckProducts<7>();
  CheckProducts<8>();
  CheckProducts<12>();
}

}  // namespace
}  // namespace velamap
