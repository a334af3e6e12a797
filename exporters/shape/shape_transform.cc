#include "exporters/shape/shape_transform.h"

#include "exporters/shape/shape_sigma.h"

namespace velamap {

PointCovariance RotateCovariance(const Eigen::Quaterniond& frame_from_shape,
                                 const PointCovariance& covariance) {
  const Eigen::Matrix3d rotation = frame_from_shape.toRotationMatrix();
  PointCovariance rotated = covariance;
  for (Eigen::MatrixXd& block : rotated.blocks) {
    for (Eigen::Index row = 0; row < block.rows(); row += 3) {
      for (Eigen::Index column = 0; column < block.cols(); column += 3) {
        const Eigen::Matrix3d turned =
            rotation * block.block<3, 3>(row, column) * rotation.transpose();
        block.block<3, 3>(row, column) = turned;
      }
    }
  }
  for (Eigen::Index row = 0; row < rotated.factor.rows(); row += 3) {
    rotated.factor.middleRows<3>(row) = (rotation * covariance.factor.middleRows<3>(row)).eval();
  }
  return rotated;
}

void MoveShape(const Rigid3& frame_from_shape, const PointCovariance* covariance_in_frame,
               MarkerShape* shape) {
  const bool is_turned =
      frame_from_shape.rotation.angularDistance(Eigen::Quaterniond::Identity()) > 0;
  for (ShapeMarker& marker : shape->markers) {
    for (int corner = 0; corner <= kNumCorners; ++corner) {
      auto& x = marker.x_in_shape_m[static_cast<std::size_t>(corner)];
      auto& sigma_m = marker.sigma_m[static_cast<std::size_t>(corner)];
      if (!x) continue;
      x = frame_from_shape * *x;
      if (!sigma_m || !is_turned) continue;
      const double largest = sigma_m->maxCoeff();
      const bool is_round = largest - sigma_m->minCoeff() <= 1e-9 * largest;
      const auto turned = PointSigma(covariance_in_frame, marker.marker_id, corner);
      if (turned || !is_round) sigma_m = turned;
    }
  }
}

}  // namespace velamap
