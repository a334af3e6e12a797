// The large products of the Schur complement. Private to this room.

#pragma once

#include <Eigen/Core>

#include "reconstruct/double_lanes.h"

namespace velamap {

// Lower triangle of sum -= rows^T rows, for k x n `rows` and n x n `sum`; what stands above the
// diagonal is overwritten in part.
void SubtractGramMatrix(const RowMajorMatrix& rows, Eigen::MatrixXd* sum);

}  // namespace velamap
