#include "importer/geometry/least_squares.h"

#include <Eigen/Cholesky>

namespace velamap {

bool SolveInPlace(Eigen::Ref<Eigen::MatrixXd> matrix, Eigen::Ref<Eigen::VectorXd> solution) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(solution);
  return solution.allFinite();
}

}  // namespace velamap
