// The regression behind SurfaceField, whose header has the model and its sources. Coordinates are
// normalized: their origin is the mean of the points, and their unit the largest distance of a
// point from it.

#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace velamap {

constexpr int kNumDrift = 10;  // monomials up to the second degree

// The monomials of the polynomial at a place.
inline Eigen::Matrix<double, kNumDrift, 1> DriftValue(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, kNumDrift, 1> drift;
  drift << 1, x, x.cwiseAbs2(), x.y() * x.z(), x.z() * x.x(), x.x() * x.y();
  return drift;
}

// The derivatives of the monomials, one row per axis.
inline Eigen::Matrix<double, 3, kNumDrift> DriftGradient(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 3, kNumDrift> gradient;
  gradient << 0, 1, 0, 0, 2 * x.x(), 0, 0, 0, x.z(), x.y(),  //
      0, 0, 1, 0, 0, 2 * x.y(), 0, x.z(), 0, x.x(),          //
      0, 0, 0, 1, 0, 0, 2 * x.z(), x.y(), x.x(), 0;
  return gradient;
}

// D of the covariance. All distances between points of the unit ball are below it.
constexpr double kThinPlateDiameter = 2.5;

// k(r) at unit amplitude.
inline double ThinPlateCovariance(double r) {
  return (2 * r - 3 * kThinPlateDiameter) * r * r +
         kThinPlateDiameter * kThinPlateDiameter * kThinPlateDiameter;
}

// k'(r) / r: times the vector from the second place to the first, it is the derivative of the
// covariance by the first place.
inline double ThinPlateSlope(double r) { return 6 * (r - kThinPlateDiameter); }

// The observations of the field, one per row: its value where the direction is zero, else its slope
// along the direction.
struct FieldRows {
  Eigen::MatrixX3d places, directions;
  Eigen::VectorXd targets;

  Eigen::Index Size() const { return targets.size(); }
  bool IsValue(Eigen::Index i) const { return directions.row(i).isZero(0); }
};

struct FieldSolution {
  Eigen::LLT<Eigen::MatrixXd> covariance;  // of the observations, with their noise
  Eigen::MatrixXd whitened_drift;          // by the factor of the covariance
  Eigen::LLT<Eigen::MatrixXd> drift_precision;
  Eigen::VectorXd drift;        // coefficients of the polynomial
  Eigen::VectorXd weights;      // of the covariance functions of the rows, at unit amplitude
  double log_likelihood = 0.0;  // up to a constant
};

// `sigmas` has the noise of each row.
FieldSolution SolveField(const FieldRows& rows, const Eigen::VectorXd& sigmas, double amplitude);

struct FieldParameters {
  double amplitude = 1.0;
  double sigma_factor = 1.0;  // of the sigmas of values
};

// The parameters with the largest likelihood; the factor is 1 if the sigmas are known.
FieldParameters MaximizeLikelihood(const FieldRows& rows, const Eigen::VectorXd& sigmas,
                                   bool sigmas_are_known);

}  // namespace velamap
