// Errors of the corners of one marker in one image that correlate, made independent.

#pragma once

#include <cmath>

#include <Eigen/Core>

namespace velamap {

// Multiply errors in sigmas, of which any two corners of a view have the same correlation along the
// same coordinate: the mean of the corners, and their differences from it. The products are
// independent and have a sigma of 1.
struct CornerWhitening {
  double of_mean = 1.0;
  double of_differences = 1.0;

  static CornerWhitening Of(double correlation, int num_corners) {
    return {1.0 / std::sqrt(1.0 + (num_corners - 1) * correlation),
            1.0 / std::sqrt(1.0 - correlation)};
  }
  CornerWhitening Inverse() const { return {1.0 / of_mean, 1.0 / of_differences}; }
};

// Applies it to `errors`, which has two rows for each corner of a view.
template <typename Derived>
void Whiten(const CornerWhitening& whitening, Derived& errors) {
  const Eigen::Index num_corners = errors.rows() / 2;
  for (Eigen::Index col = 0; col < errors.cols(); ++col) {
    for (Eigen::Index coordinate = 0; coordinate < 2; ++coordinate) {
      double sum = 0.0;
      for (Eigen::Index i = 0; i < num_corners; ++i) sum += errors(2 * i + coordinate, col);
      const double shift =
          (whitening.of_mean - whitening.of_differences) * sum / static_cast<double>(num_corners);
      for (Eigen::Index i = 0; i < num_corners; ++i) {
        double& error = errors(2 * i + coordinate, col);
        error = whitening.of_differences * error + shift;
      }
    }
  }
}

}  // namespace velamap
