// The large products of the Schur complement, with AVX2 where the processor has it, else Eigen's.
// Private to this room.

#pragma once

#include <Eigen/Core>

#include "reconstruct/solve/double_lanes.h"

namespace velamap {

// Lower triangle of sum -= rows^T rows, for k x n `rows` and n x n `sum`; what stands above the
// diagonal is overwritten in part.
void SubtractGramMatrix(const RowMajorMatrix& rows, Eigen::MatrixXd* sum);

// rows = rows * root^-T for a lower triangular root.
void SolveTransposedOnTheRight(const Eigen::MatrixXd& root, RowMajorMatrix* rows);

}  // namespace velamap
