#include "reconstruct/geometry/covariance_update.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>

#include "importer/base/error.h"

namespace velamap {
namespace {

void AppendColumns(const Eigen::MatrixXd& columns, double sign, PointCovariance* covariance) {
  const Eigen::Index count = covariance->factor.cols();
  covariance->factor.conservativeResize(Eigen::NoChange, count + columns.cols());
  covariance->factor.rightCols(columns.cols()) = columns;
  covariance->signs.conservativeResize(count + columns.cols());
  covariance->signs.tail(columns.cols()).setConstant(sign);
}

Eigen::Vector3d Centroid(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

}  // namespace

Eigen::MatrixXd Multiply(const PointCovariance& covariance, const Eigen::MatrixXd& vectors) {
  Eigen::MatrixXd result = covariance.factor * (covariance.signs.asDiagonal() *
                                                (covariance.factor.transpose() * vectors));
  Eigen::Index begin = 0;
  for (const Eigen::MatrixXd& block : covariance.blocks) {
    result.middleRows(begin, block.rows()) += block * vectors.middleRows(begin, block.rows());
    begin += block.rows();
  }
  return result;
}

double Trace(const PointCovariance& covariance) {
  double trace = covariance.signs.dot(covariance.factor.colwise().squaredNorm().transpose());
  for (const Eigen::MatrixXd& block : covariance.blocks) trace += block.trace();
  return trace;
}

Eigen::MatrixXd RigidMotions(const std::vector<Eigen::Vector3d>& x_in_world) {
  const Eigen::Vector3d centroid = Centroid(x_in_world);
  double extent = 0.0;
  for (const Eigen::Vector3d& x : x_in_world) extent = std::max(extent, (x - centroid).norm());
  Eigen::MatrixXd motions(3 * x_in_world.size(), 6);
  for (std::size_t i = 0; i < x_in_world.size(); ++i) {
    const Eigen::Vector3d x = (x_in_world[i] - centroid) / extent;
    for (int axis = 0; axis < 3; ++axis) {
      motions.block<3, 1>(3 * i, axis) = Eigen::Vector3d::Unit(axis);
      motions.block<3, 1>(3 * i, 3 + axis) = Eigen::Vector3d::Unit(axis).cross(x);
    }
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(motions);
  qr.setThreshold(1e-9);
  return qr.householderQ() * Eigen::MatrixXd::Identity(motions.rows(), qr.rank());
}

void AddMeasurements(const Eigen::MatrixXd& gradients, const Eigen::VectorXd& sigmas,
                     PointCovariance* covariance) {
  if (gradients.cols() == 0) return;
  Eigen::MatrixXd columns = Multiply(*covariance, gradients);
  Eigen::MatrixXd innovation = gradients.transpose() * columns;
  innovation.diagonal() += sigmas.cwiseAbs2();
  const Eigen::LLT<Eigen::MatrixXd> root(innovation);
  VELAMAP_CHECK(root.info() == Eigen::Success);
  root.matrixU().solveInPlace<Eigen::OnTheRight>(columns);
  AppendColumns(columns, -1.0, covariance);
}

void ToInnerConstraints(const std::vector<Eigen::Vector3d>& x_in_world,
                        PointCovariance* covariance) {
  const Eigen::MatrixXd motions = RigidMotions(x_in_world);
  covariance->factor -= motions * (motions.transpose() * covariance->factor).eval();
  // P D P = D - (Q B^T + B Q^T), Q the motions, B = (D - Q Q^T D / 2) Q; and
  // -(q b^T + b q^T) = (c q - b / c)(...)^T / 2 - (c q + b / c)(...)^T / 2 for any c.
  PointCovariance only_blocks{covariance->point3D_ids, covariance->blocks,
                              Eigen::MatrixXd::Zero(motions.rows(), 0), Eigen::VectorXd()};
  Eigen::MatrixXd rest = Multiply(only_blocks, motions);
  rest -= 0.5 * motions * (motions.transpose() * rest).eval();
  Eigen::MatrixXd differences(rest.rows(), rest.cols()), sums(rest.rows(), rest.cols());
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    const double c = std::sqrt(rest.col(i).norm());  // evens out both parts
    if (c == 0.0) {
      differences.col(i).setZero();
      sums.col(i).setZero();
      continue;
    }
    differences.col(i) = (c * motions.col(i) - rest.col(i) / c) / std::sqrt(2.0);
    sums.col(i) = (c * motions.col(i) + rest.col(i) / c) / std::sqrt(2.0);
  }
  AppendColumns(differences, 1.0, covariance);
  AppendColumns(sums, -1.0, covariance);
}

Eigen::VectorXd ScaleGradient(const std::vector<Eigen::Vector3d>& x_in_world) {
  const Eigen::Vector3d centroid = Centroid(x_in_world);
  Eigen::VectorXd gradient(3 * x_in_world.size());
  for (std::size_t i = 0; i < x_in_world.size(); ++i) {
    gradient.segment<3>(3 * i) = x_in_world[i] - centroid;
  }
  return gradient / gradient.squaredNorm();
}

}  // namespace velamap
