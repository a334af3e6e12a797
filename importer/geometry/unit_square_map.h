// The homography between a unit square and a quad of the image (Heckbert, "Fundamentals of Texture
// Mapping and Image Warping", 1989).

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "importer/geometry/quad.h"

namespace velamap {

// Takes (0,0) (1,0) (1,1) (0,1) to the corners 0, 1, 2, 3 of the quad. A quad without area gives
// non-finite values.
class UnitSquareMap {
 public:
  explicit UnitSquareMap(const QuadCorners& quad) {
    const Eigen::Vector2d sum = quad[0] - quad[1] + quad[2] - quad[3];
    Eigen::Matrix2d sides;
    sides << quad[1] - quad[2], quad[3] - quad[2];
    const Eigen::Vector2d g = sides.inverse() * sum;
    image_from_square_ << quad[1] - quad[0] + g.x() * quad[1], quad[3] - quad[0] + g.y() * quad[3],
        quad[0], g.x(), g.y(), 1.0;
    square_from_image_ = image_from_square_.inverse();
  }

  Eigen::Vector2d ToImage(double u, double v) const {
    return (image_from_square_ * Eigen::Vector3d(u, v, 1)).hnormalized();
  }

  Eigen::Vector2d ToSquare(const Eigen::Vector2d& x_px) const {
    return (square_from_image_ * x_px.homogeneous()).hnormalized();
  }

  // Maps homogeneous vectors.
  const Eigen::Matrix3d& square_from_image() const { return square_from_image_; }

 private:
  Eigen::Matrix3d image_from_square_, square_from_image_;
};

}  // namespace velamap
