// The Gaussian process regression of SurfaceField. surface_field.h describes the model and its
// sources. Coordinates are normalized: the origin is the mean of the points, and the unit is the
// largest distance of a point from it.

#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace velamap {

constexpr int kNumDrift = 10;  // monomials up to the second degree

// The values of the monomials at `x`.
inline Eigen::Matrix<double, kNumDrift, 1> DriftValue(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, kNumDrift, 1> drift;
  drift << 1, x, x.cwiseAbs2(), x.y() * x.z(), x.z() * x.x(), x.x() * x.y();
  return drift;
}

// The derivatives of the monomials at `x`, one row per axis.
inline Eigen::Matrix<double, 3, kNumDrift> DriftGradient(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 3, kNumDrift> gradient;
  gradient << 0, 1, 0, 0, 2 * x.x(), 0, 0, 0, x.z(), x.y(),  //
      0, 0, 1, 0, 0, 2 * x.y(), 0, x.z(), 0, x.x(),          //
      0, 0, 0, 1, 0, 0, 2 * x.z(), x.y(), x.x(), 0;
  return gradient;
}

// D of the covariance. It exceeds all distances between points of the unit ball.
constexpr double kThinPlateDiameter = 2.5;

// k(r) for an amplitude of 1.
inline double ThinPlateCovariance(double r) {
  return (2 * r - 3 * kThinPlateDiameter) * r * r +
         kThinPlateDiameter * kThinPlateDiameter * kThinPlateDiameter;
}

// k'(r) / r. Multiplied by the vector from the second place to the first, it is the derivative of
// the covariance with respect to the first place.
inline double ThinPlateSlope(double r) { return 6 * (r - kThinPlateDiameter); }

// The observations of the field, one per row. A row with a direction of zero observes the value,
// any other one the slope along its direction.
struct FieldRows {
  Eigen::MatrixX3d places, directions;
  Eigen::VectorXd targets;  // observed values and slopes

  Eigen::Index Size() const { return targets.size(); }
  bool IsValue(Eigen::Index i) const { return directions.row(i).isZero(0); }
};

struct FieldSolution {
  Eigen::LLT<Eigen::MatrixXd> covariance;  // of the observations, including their noise
  Eigen::MatrixXd whitened_drift;  // monomials of the rows, whitened by the factor of `covariance`
  Eigen::LLT<Eigen::MatrixXd> drift_precision;  // of the coefficients of the polynomial
  Eigen::VectorXd drift;                        // coefficients of the polynomial
  Eigen::VectorXd weights;      // of the covariance functions of the rows, for an amplitude of 1
  double log_likelihood = 0.0;  // up to a constant
};

// `sigmas` holds the standard deviation of the noise of each row.
FieldSolution SolveField(const FieldRows& rows, const Eigen::VectorXd& sigmas, double amplitude);

struct FieldParameters {
  double amplitude = 1.0;
  double sigma_factor = 1.0;  // scales the sigmas of the rows that observe values
};

// The parameters with the maximum likelihood. The factor stays 1 if the sigmas are known.
FieldParameters MaximizeLikelihood(const FieldRows& rows, const Eigen::VectorXd& sigmas,
                                   bool sigmas_are_known);

}  // namespace velamap
