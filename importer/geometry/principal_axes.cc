#include "importer/geometry/principal_axes.h"

#include <Eigen/Eigenvalues>

#include "importer/base/error.h"

namespace velamap {

PrincipalAxes AxesOfScatter(const Eigen::Vector3d& mean, const Eigen::Matrix3d& scatter) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  return {mean, solver.eigenvectors(), solver.eigenvalues()};
}

PrincipalAxes ComputePrincipalAxes(const std::vector<Eigen::Vector3d>& points) {
  VELAMAP_CHECK(!points.empty());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : points) mean += x;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points) scatter += (x - mean) * (x - mean).transpose();
  return AxesOfScatter(mean, scatter);
}

}  // namespace velamap
