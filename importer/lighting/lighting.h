// How the light on a marker differs from one that is even or has a linear gradient: it falls off
// along the marker, or the edges of shadows cross it.
//
//   lighting(x) = exp(bend_xx x^2 + bend_xy x y + bend_yy y^2) * prod_k (1 - depth_k * band_k(x))
//
// with places x relative to the marker's middle, in units of its diagonal; band_k is 1 between two
// parallel edges, each blurred by a Gaussian. A shadow whose other edge lies beyond the marker is a
// wide band; a bright band has a negative depth.

#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace velamap {

class Lighting {
 public:
  enum Index { kBend = 0, kFirstBand = 3 };
  enum BandIndex {
    kAngle,     // of the normal of the edges, rad
    kOffset,    // of the first edge along the normal
    kLogWidth,  // from there to the second edge
    kLogBlur,   // sigma of the edges
    kDepth,
    kNumOfBand
  };
  using Band = Eigen::Matrix<double, kNumOfBand, 1>;

  bool IsEven() const { return parameters_.isZero(0); }
  int num_bands() const { return static_cast<int>(parameters_.size() - kFirstBand) / kNumOfBand; }
  const Eigen::VectorXd& parameters() const { return parameters_; }
  void AddBand(const Band& band);

  // Adds a step, kept within the limits of what a camera sees of a shadow on a marker.
  void Move(const Eigen::VectorXd& step, double min_blur);

  // Natural logarithm of the lighting; `by_parameters`, of their size, may be null.
  double LogAt(const Eigen::Vector2d& place, Eigen::VectorXd* by_parameters = nullptr) const;

 private:
  Eigen::VectorXd parameters_ = Eigen::VectorXd::Zero(kFirstBand);
};

}  // namespace velamap
