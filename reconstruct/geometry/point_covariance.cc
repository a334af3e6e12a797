#include "reconstruct/geometry/point_covariance.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

namespace velamap {
namespace {

// First row of every block, by block.
std::vector<int> BlockBegins(const PointCovariance& covariance) {
  std::vector<int> begins;
  int begin = 0;
  for (const Eigen::MatrixXd& block : covariance.blocks) {
    begins.push_back(begin);
    begin += static_cast<int>(block.rows());
  }
  return begins;
}

// A gradient by rows, which costs less than a 3n-vector, because few points take part.
struct RowGradient {
  std::vector<int> begins;  // first row of each point
  std::vector<Eigen::Vector3d> values;
  Eigen::VectorXd by_factor;  // factor^T * gradient
};

RowGradient MakeRowGradient(const PointCovariance& covariance, const PointGradient& gradient) {
  RowGradient rows;
  rows.by_factor.setZero(covariance.factor.cols());
  for (const auto& [point3D_id, value] : gradient) {
    const int idx = covariance.IndexOf(point3D_id);
    if (idx < 0) throw std::logic_error("no covariance of point " + std::to_string(point3D_id));
    rows.begins.push_back(3 * idx);
    rows.values.push_back(value);
    rows.by_factor.noalias() += covariance.factor.middleRows<3>(3 * idx).transpose() * value;
  }
  return rows;
}

}  // namespace

int PointCovariance::IndexOf(Point3DId point3D_id) const {
  const auto it = std::lower_bound(point3D_ids.begin(), point3D_ids.end(), point3D_id);
  if (it == point3D_ids.end() || *it != point3D_id) return -1;
  return static_cast<int>(it - point3D_ids.begin());
}

double CovarianceOf(const PointCovariance& covariance, const PointGradient& a,
                    const PointGradient& b) {
  const RowGradient rows_a = MakeRowGradient(covariance, a);
  const RowGradient rows_b = MakeRowGradient(covariance, b);
  double result = rows_a.by_factor.cwiseProduct(covariance.signs).dot(rows_b.by_factor);
  const std::vector<int> block_begins = BlockBegins(covariance);
  const auto block_of = [&](int row) {
    return static_cast<std::size_t>(
        std::upper_bound(block_begins.begin(), block_begins.end(), row) - block_begins.begin() - 1);
  };
  std::vector<std::vector<std::size_t>> b_in_block(covariance.blocks.size());
  for (std::size_t j = 0; j < rows_b.begins.size(); ++j) {
    b_in_block[block_of(rows_b.begins[j])].push_back(j);
  }
  for (std::size_t i = 0; i < rows_a.begins.size(); ++i) {
    const std::size_t block = block_of(rows_a.begins[i]);
    for (const std::size_t j : b_in_block[block]) {
      result += rows_a.values[i].dot(
          covariance.blocks[block].block<3, 3>(rows_a.begins[i] - block_begins[block],
                                               rows_b.begins[j] - block_begins[block]) *
          rows_b.values[j]);
    }
  }
  return result;
}

double VarianceOf(const PointCovariance& covariance, const PointGradient& gradient) {
  return std::max(0.0, CovarianceOf(covariance, gradient, gradient));
}

Eigen::Matrix3d PointCovarianceOf(const PointCovariance& covariance, Point3DId point3D_id) {
  const int idx = covariance.IndexOf(point3D_id);
  if (idx < 0) throw std::logic_error("no covariance of point " + std::to_string(point3D_id));
  const auto rows = covariance.factor.middleRows<3>(3 * idx);
  Eigen::Matrix3d result = rows * covariance.signs.asDiagonal() * rows.transpose();
  int begin = 0;
  for (const Eigen::MatrixXd& block : covariance.blocks) {
    const int in_block = 3 * idx - begin;
    if (in_block < block.rows()) {
      result += block.block<3, 3>(in_block, in_block);
      break;
    }
    begin += static_cast<int>(block.rows());
  }
  return result;
}

PointCovariance Subset(const PointCovariance& covariance, const std::vector<Point3DId>& ids) {
  const std::set<Point3DId> wanted(ids.begin(), ids.end());
  PointCovariance subset;
  std::vector<int> rows;
  int begin = 0;
  for (const Eigen::MatrixXd& block : covariance.blocks) {
    std::vector<int> rows_in_block;
    for (int row = 0; row < block.rows(); row += 3) {
      const Point3DId point3D_id = covariance.point3D_ids[(begin + row) / 3];
      if (wanted.count(point3D_id) == 0) continue;
      subset.point3D_ids.push_back(point3D_id);
      for (int i = 0; i < 3; ++i) rows_in_block.push_back(row + i);
    }
    if (!rows_in_block.empty()) subset.blocks.push_back(block(rows_in_block, rows_in_block));
    for (const int row : rows_in_block) rows.push_back(begin + row);
    begin += static_cast<int>(block.rows());
  }
  subset.factor = covariance.factor(rows, Eigen::all);
  subset.signs = covariance.signs;
  return subset;
}

}  // namespace velamap
