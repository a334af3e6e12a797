#include "exporters/shape/joint_covariance.h"

#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "exporters/shape/shape_sigma.h"

namespace velamap {
namespace {

// The block of every point and its first row there.
std::vector<std::pair<std::size_t, int>> PlacesInBlocks(const PointCovariance& covariance) {
  std::vector<std::pair<std::size_t, int>> places;
  for (std::size_t block = 0; block < covariance.blocks.size(); ++block) {
    for (int row = 0; row < covariance.blocks[block].rows(); row += 3) {
      places.emplace_back(block, row);
    }
  }
  return places;
}

}  // namespace

Eigen::MatrixXd JointCovarianceOf(const PointCovariance& covariance,
                                  const std::vector<PointGradient>& gradients) {
  const auto places = PlacesInBlocks(covariance);
  const auto num_functions = static_cast<Eigen::Index>(gradients.size());
  Eigen::MatrixXd by_factor = Eigen::MatrixXd::Zero(num_functions, covariance.factor.cols());
  // The gradients that involve each block.
  std::map<std::size_t, std::map<Eigen::Index, Eigen::VectorXd>> by_block;
  for (Eigen::Index i = 0; i < num_functions; ++i) {
    for (const auto& [point3D_id, value] : gradients[static_cast<std::size_t>(i)]) {
      const int idx = covariance.IndexOf(point3D_id);
      if (idx < 0) throw std::logic_error("no covariance of point " + std::to_string(point3D_id));
      by_factor.row(i) += value.transpose() * covariance.factor.middleRows<3>(3 * idx);
      const auto& [block, row] = places[static_cast<std::size_t>(idx)];
      const Eigen::Index size = covariance.blocks[block].rows();
      const auto it = by_block[block].emplace(i, Eigen::VectorXd::Zero(size)).first;
      it->second.segment<3>(row) += value;
    }
  }
  Eigen::MatrixXd result = by_factor * covariance.signs.asDiagonal() * by_factor.transpose();
  for (const auto& [block, functions] : by_block) {
    for (const auto& [i, a] : functions) {
      const Eigen::VectorXd product = covariance.blocks[block] * a;
      for (const auto& [j, b] : functions) result(i, j) += product.dot(b);
    }
  }
  return result;
}

Eigen::MatrixXd JointCovarianceOfPoints(const PointCovariance* covariance,
                                        const std::vector<CornerId>& points) {
  std::vector<PointGradient> gradients;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      PointGradient gradient;
      AddPointGradient(points[i].marker_id, points[i].corner, Eigen::Vector3d::Unit(axis),
                       &gradient);
      if (!HasPointsOf(gradient, covariance)) continue;
      gradients.push_back(std::move(gradient));
      rows.push_back(static_cast<Eigen::Index>(3 * i) + axis);
    }
  }
  const auto size = static_cast<Eigen::Index>(3 * points.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size, size);
  if (!rows.empty()) all(rows, rows) = JointCovarianceOf(*covariance, gradients);
  return all;
}

}  // namespace velamap
