// A joint covariance as the matrix that it stands for.

#pragma once

#include <Eigen/Core>

#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// 3n x 3n, m^2.
inline Eigen::MatrixXd Dense(const PointCovariance& points) {
  Eigen::MatrixXd dense = points.factor * points.signs.asDiagonal() * points.factor.transpose();
  Eigen::Index begin = 0;
  for (const Eigen::MatrixXd& block : points.blocks) {
    dense.block(begin, begin, block.rows(), block.rows()) += block;
    begin += block.rows();
  }
  return dense;
}

}  // namespace velamap
