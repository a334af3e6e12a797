#include "importer/geometry/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

namespace velamap {

SymmetricEigen DecomposeSymmetric(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace velamap
