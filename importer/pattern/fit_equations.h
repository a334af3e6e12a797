// Normal equations of a least-squares problem with few parameters and many observations: J^T J, J^T
// r and r^T r. Groups of observations are summed in single precision, the groups in double
// precision.

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "importer/lanes/float_lanes.h"
#include "importer/pattern/refined_corners.h"

namespace velamap {

// Shortens a step of one parameter, so that it stays within its limits.
inline void LimitParameter(double min, double max, double value, double* step) {
  if (value + *step < min) *step = min - value;
  if (value + *step > max) *step = max - value;
}

template <int kCount>
class FitEquations {
 public:
  using Vector = Eigen::Matrix<double, kCount, 1>;
  using Matrix = Eigen::Matrix<double, kCount, kCount>;
  using Jacobian = FloatsArray<kCount>;

  // Reserves memory for this many groups of observations.
  void Reserve(std::size_t num_groups) {
    jacobians_.reserve(num_groups);
    residuals_.reserve(num_groups);
  }

  // Resets the sums. Without `with_hessian` the Hessian and the Jacobians stay.
  void Clear(bool with_hessian) {
    with_hessian_ = with_hessian;
    num_observations_ = 0;
    gradient_lanes_ = {};
    squares_ = Floats{};
    residuals_.clear();
    if (with_hessian) jacobians_.clear();
  }

  // Adds a group of observations, of which the first `num_valid` count. Changes `jacobian`.
  void Add(Jacobian* jacobian, Floats residual, int num_valid) {
    if (num_valid < kLanes) {
      const Floats mask = FirstLanes(num_valid);
      residual *= mask;
      for (Floats& derivative : *jacobian) derivative *= mask;
    }
    num_observations_ += std::min(num_valid, kLanes);
    for (std::size_t i = 0; i < kCount; ++i) gradient_lanes_[i] += (*jacobian)[i] * residual;
    squares_ += residual * residual;
    residuals_.push_back({residual});
    if (with_hessian_) jacobians_.push_back(*jacobian);
  }

  // Completes the sums. `departure` is the difference between the parameters and their priors,
  // `weight` the weight of its square.
  void Finish(const Vector& departure, const Vector& weight) {
    for (int i = 0; i < kCount; ++i) {
      gradient_[i] = Sum(gradient_lanes_[static_cast<std::size_t>(i)]);
    }
    gradient_ += weight.cwiseProduct(departure);
    cost_ = squared_residuals() + departure.cwiseAbs2().dot(weight);
    if (!with_hessian_) return;
    hessian_ = weight.asDiagonal();
    // Blocks that fit into the first-level cache.
    constexpr std::size_t kBlock = 64;
    for (std::size_t begin = 0; begin < jacobians_.size(); begin += kBlock) {
      AddProducts(begin, std::min(begin + kBlock, jacobians_.size()));
    }
    hessian_.template triangularView<Eigen::StrictlyUpper>() = hessian_.transpose();
  }

  // Changes the residuals to first order for a short step of the parameters.
  void Predict(const Vector& step) {
    const Eigen::Matrix<float, kCount, 1> by = step.template cast<float>();
    squares_ = Floats{};
    for (std::size_t k = 0; k < jacobians_.size(); ++k) {
      Floats residual = residuals_[k][0];
      for (std::size_t i = 0; i < kCount; ++i) {
        residual += jacobians_[k][i] * by[static_cast<Eigen::Index>(i)];
      }
      residuals_[k][0] = residual;
      squares_ += residual * residual;
    }
  }

  int num_observations() const { return num_observations_; }
  const Matrix& hessian() const { return hessian_; }
  const Vector& gradient() const { return gradient_; }
  double squared_residuals() const { return Sum(squares_); }
  double cost() const { return cost_; }  // with the priors
  double Rms() const { return std::sqrt(squared_residuals() / num_observations_); }

  // `inverse` is the inverse of the Hessian; squared_slope(jacobian) is the squared slope of the
  // grey levels. The leverage is averaged over some of the observations.
  template <typename SquaredSlope>
  ResidualNoise Noise(const Matrix& inverse, const SquaredSlope& squared_slope) const {
    constexpr std::size_t kStride = 4;
    const Eigen::Matrix<float, kCount, kCount> covariance = inverse.template cast<float>();
    Floats weights{}, weighted_squares{}, some_weights{}, followed{};
    for (std::size_t k = 0; k < jacobians_.size(); ++k) {
      const Floats weight = squared_slope(jacobians_[k]);
      weights += weight;
      weighted_squares += weight * residuals_[k][0] * residuals_[k][0];
      if (k % kStride != 0) continue;
      some_weights += weight;
      followed += weight * Leverage(covariance, jacobians_[k]);
    }
    const double leverage = Sum(some_weights) > 0 ? Sum(followed) / Sum(some_weights) : 0.0;
    return ResidualNoise(Sum(weighted_squares), Sum(weights) * (1 - leverage));
  }

 private:
  static constexpr int kRows = 2, kColumns = kCount % 5 == 0 ? 5 : 6;  // sums fit the registers
  static_assert(kCount % kRows == 0 && kCount % kColumns == 0);

  void AddProducts(std::size_t begin, std::size_t end) {
    for (int row = 0; row < kCount; row += kRows) {
      for (int column = 0; column < row + kRows; column += kColumns) {
        Floats sums[kRows][kColumns] = {};
        for (std::size_t k = begin; k < end; ++k) {
          const Floats* a = jacobians_[k].begin() + row;
          const Floats* b = jacobians_[k].begin() + column;
          for (int i = 0; i < kRows; ++i) {
            for (int j = 0; j < kColumns; ++j) sums[i][j] += a[i] * b[j];
          }
        }
        for (int i = 0; i < kRows; ++i) {
          for (int j = 0; j < kColumns; ++j) hessian_(row + i, column + j) += Sum(sums[i][j]);
        }
      }
    }
  }

  static Floats Leverage(const Eigen::Matrix<float, kCount, kCount>& covariance,
                         const Jacobian& jacobian) {
    Floats leverage{};
    for (int i = 0; i < kCount; ++i) {
      Floats by_covariance = 0.5f * covariance(i, i) * jacobian[static_cast<std::size_t>(i)];
      for (int j = 0; j < i; ++j) {
        by_covariance += covariance(j, i) * jacobian[static_cast<std::size_t>(j)];
      }
      leverage += 2.0f * by_covariance * jacobian[static_cast<std::size_t>(i)];
    }
    return leverage;
  }

  bool with_hessian_ = false;
  int num_observations_ = 0;
  Jacobian gradient_lanes_;
  Floats squares_{};
  std::vector<Jacobian> jacobians_;
  std::vector<FloatsArray<1>> residuals_;
  Matrix hessian_ = Matrix::Zero();
  Vector gradient_ = Vector::Zero();
  double cost_ = 0.0;
};

}  // namespace velamap
