#include "exporters/shape/principal_axes.h"

#include <Eigen/Eigenvalues>

#include "importer/base/error.h"

namespace velamap {

PrincipalAxes ComputePrincipalAxes(const std::vector<Eigen::Vector3d>& points) {
  VELAMAP_CHECK(!points.empty());
  PrincipalAxes axes;
  for (const Eigen::Vector3d& x : points) axes.mean += x;
  axes.mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points) {
    scatter += (x - axes.mean) * (x - axes.mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  axes.directions = solver.eigenvectors();
  axes.sums_of_squares = solver.eigenvalues();
  return axes;
}

}  // namespace velamap
