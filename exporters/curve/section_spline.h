// Smoothing spline through the markers of a line, as a space curve:
//
//   min over f   (f(t) - x)^T C^-1 (f(t) - x)  +  lambda * integral of |f'''|^2,   0 <= t <= 1
//
// f is a cubic B-spline with a knot at the chord length of every marker; C is the joint covariance
// of the markers. The usual penalty on f'' would straighten both ends and reduce the entry and exit
// angles of a sail, while a penalty on f''' costs nothing for parabolas. All lines of a sail share
// one lambda, because they are of one cloth and determine it better together. It minimizes the
// expected error: Mallows' Cp ("Some comments on Cp", 1973) if C is known, otherwise generalized
// cross-validation (Golub, Heath and Wahba, 1979), which only assumes equal noise. Cross-validation
// needs five points on a curve; if all have four, C is that of NominalSigma(). A tenth of that
// lambda is used, because smoothing biases angles and draft more than the points. As lambda
// approaches 0, f interpolates.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "exporters/curve/space_curve.h"

namespace velamap {

// Points closer together than this count as one point of a curve.
inline constexpr double kSamePlace_m = 1e-3;

// Chord lengths from the first point, normalized to 1. Needs at least two points and distinct
// neighbours.
Eigen::ArrayXd ChordLengthParameters(const Eigen::Matrix3Xd& points_in_shape_m);

// Points of one curve, in order, and the covariance of their noise: 3n x 3n (x y z of each point in
// turn, m^2), or empty if it is unknown. Needs at least four points. Sigmas are at least 1
// micrometre.
struct CurveData {
  Eigen::Matrix3Xd points_in_shape_m;
  Eigen::MatrixXd covariance_m2;
};

// Chooses the smoothing of these curves, all with or all without a covariance: lambda relative to
// the ratio of the squared weights of points and penalty, which makes it dimensionless.
double ChooseSmoothing(const std::vector<CurveData>& curves);

struct CurveFit {
  SpaceCurve curve;
  Eigen::ArrayXd parameters;  // of the points
  // Trace of the hat matrix / 3, from 3 for a parabola to the number of points for interpolation.
  double num_effective_parameters = 0.0;
};
CurveFit FitCurve(const CurveData& data, double smoothing);

// Returns the curve only, which is faster.
SpaceCurve FitCurveOnly(const CurveData& data, double smoothing);

// Interpolating curves with common parameters (ascending from 0 to 1): poles = points *
// poles_from_points. Cubic with the smallest integral of |f'''|^2, or of a lower degree for fewer
// than four points.
struct Interpolation {
  int degree = 3;
  Eigen::ArrayXd knots;
  Eigen::MatrixXd poles_from_points;  // n x number of poles
};
Interpolation MakeInterpolation(const Eigen::ArrayXd& parameters);

}  // namespace velamap
