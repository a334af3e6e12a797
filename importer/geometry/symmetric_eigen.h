// Eigenvalues and eigenvectors of a symmetric matrix of any size. One file instantiates Eigen's
// solver, which takes several seconds to compile.

#pragma once

#include <Eigen/Core>

namespace velamap {

struct SymmetricEigen {
  Eigen::VectorXd values;   // ascending
  Eigen::MatrixXd vectors;  // n x n, orthonormal; column i belongs to values[i]
};

// Reads only the lower triangle of `matrix`, n x n.
SymmetricEigen DecomposeSymmetric(const Eigen::MatrixXd& matrix);

}  // namespace velamap
