// Optimized copies of Eigen's products and solvers of large matrices, first on the linker's command
// line. Of several copies of a template's function the linker keeps the first, for the libraries
// too; those in the tests are hardly optimized and made products up to ten times slower.

#include <Eigen/Cholesky>

namespace velamap {

Eigen::MatrixXd InstantiateProducts(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::LLT<Eigen::MatrixXd> factor(a * b);
  return factor.solve(a.transpose() * b) + factor.matrixL().solve(b * b.transpose()) +
         a * b.col(0) * (a.transpose() * b.col(0)).transpose();
}

}  // namespace velamap
