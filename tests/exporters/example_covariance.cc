#include "tests/exporters/example_covariance.h"

#include <map>

#include <Eigen/Cholesky>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

Eigen::MatrixXd Noise(int rows, int cols, std::mt19937* random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(*random); });
}

}  // namespace

PointCovariance ExampleCovariance(const Model& model, double sigma_m, std::uint32_t seed) {
  std::mt19937 random(seed);
  PointCovariance covariance;
  std::map<int, int> num_corners_of;
  for (const auto& [point3D_id, point] : model.points3D) {
    covariance.point3D_ids.push_back(point3D_id);
    ++num_corners_of[CornerFromPoint3DId(point3D_id).marker_id];
  }
  for (const auto& [marker_id, num_corners] : num_corners_of) {
    const int size = 3 * num_corners;
    const Eigen::MatrixXd root = 0.3 * Noise(size, size, &random);
    covariance.blocks.push_back(sigma_m * sigma_m *
                                (root * root.transpose() + Eigen::MatrixXd::Identity(size, size)));
  }
  const int num_rows = 3 * static_cast<int>(covariance.point3D_ids.size());
  covariance.factor = sigma_m * Noise(num_rows, 3, &random);
  // Shorter than the least that the blocks give in any direction.
  covariance.factor.col(2) *= 0.5 * sigma_m / covariance.factor.col(2).norm();
  covariance.signs = Eigen::Vector3d(1, 1, -1);
  return covariance;
}

AdjustmentUncertainty ExampleUncertainty(const Model& model) {
  AdjustmentUncertainty uncertainty;
  uncertainty.points = ExampleCovariance(model, 1e-4, 11);
  uncertainty.relative_scale_sigma = 3e-4;
  uncertainty.variance_factor = 1.2;
  return uncertainty;
}

Eigen::MatrixXd DenseCovariance(const PointCovariance& covariance) {
  Eigen::MatrixXd dense =
      covariance.factor * covariance.signs.asDiagonal() * covariance.factor.transpose();
  Eigen::Index begin = 0;
  for (const Eigen::MatrixXd& block : covariance.blocks) {
    dense.block(begin, begin, block.rows(), block.rows()) += block;
    begin += block.rows();
  }
  return dense;
}

void SampleShapes(const MarkerShape& shape, const PointCovariance& covariance, int num_samples,
                  const std::function<void(const MarkerShape&)>& visit) {
  std::mt19937 random(5);
  const Eigen::MatrixXd root = DenseCovariance(covariance).llt().matrixL();
  for (int i = 0; i < num_samples; ++i) {
    const Eigen::VectorXd offsets = root * Noise(static_cast<int>(root.rows()), 1, &random);
    MarkerShape sample = shape;
    for (ShapeMarker& marker : sample.markers) {
      if (marker.IsWhole()) marker.x_in_shape_m[0]->setZero();
      for (int corner = 1; corner <= kNumCorners; ++corner) {
        auto& x = marker.x_in_shape_m[corner];
        const int idx = covariance.IndexOf(Point3DIdFromCorner({marker.marker_id, corner}));
        if (!x || idx < 0) continue;
        *x += offsets.segment<3>(3 * idx);
        if (marker.IsWhole()) *marker.x_in_shape_m[0] += *x / kNumCorners;
      }
    }
    visit(sample);
  }
}

double SampledSigma(const MarkerShape& shape, const PointCovariance& covariance,
                    const std::function<double(const MarkerShape&)>& figure) {
  constexpr int kNumSamples = 3000;
  std::vector<double> values;
  SampleShapes(shape, covariance, kNumSamples,
               [&](const MarkerShape& sample) { values.push_back(figure(sample)); });
  return ComputeStatistics(std::move(values)).standard_deviation;
}

}  // namespace velamap
