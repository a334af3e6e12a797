// Smoothing spline through the markers of a line, as a curve in space:
//
//   min over f   (f(t) - x)^T C^-1 (f(t) - x)  +  lambda * integral of |f'''|^2,   0 <= t <= 1
//
// f is a cubic B-spline with a knot at every marker's chord length, C the joint covariance of the
// markers. The usual penalty on f'' would make f straight at both ends and a sail's entry and exit
// angles too small; f''' leaves parabolas alone. lambda is chosen once for all lines of a sail,
// which are of one cloth and together tell more than each alone. It minimises the expected error:
// Mallows' Cp ("Some comments on Cp", 1973) where C is known, else generalised cross-validation
// (Golub, Heath and Wahba, 1979), which needs the noise to be alike, not known; a tenth of that is
// used, because angles and draft suffer sooner than the points. For lambda to 0 f interpolates.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

struct SpaceCurve {
  int degree = 3;
  Eigen::ArrayXd knots;  // degree + 1 times 0, ascending, degree + 1 times 1
  Eigen::Matrix3Xd poles_in_shape_m;
};

struct CurveJet {
  Eigen::Vector3d x, x_t, x_tt;  // m, and per unit of t
};

Eigen::Vector3d EvaluateCurve(const SpaceCurve& curve, double t);
CurveJet EvaluateCurveJet(const SpaceCurve& curve, double t);

// Chord lengths from the first point over that of the whole line. At least two points, no two
// neighbours in one place.
Eigen::ArrayXd ChordLengthParameters(const Eigen::Matrix3Xd& points_in_shape_m);

// Points of one curve, in order along it, and their noise: 3n x 3n (x y z of each point in turn,
// m^2) or empty where it is not known. At least four points; sigmas count with 1 micrometre at
// least.
struct CurveData {
  Eigen::Matrix3Xd points_in_shape_m;
  Eigen::MatrixXd covariance_m2;
};

// The smoothing for these curves, all with or all without a covariance: lambda relative to the
// ratio of the squared weights of the points to those of the penalty, so that it has no unit.
double ChooseSmoothing(const std::vector<CurveData>& curves);

struct CurveFit {
  SpaceCurve curve;
  Eigen::ArrayXd parameters;              // of the points
  double num_effective_parameters = 0.0;  // trace of the hat matrix / 3: the number of points means
                                          // that it interpolates, 3 that it is a parabola
};
CurveFit FitCurve(const CurveData& data, double smoothing);

// Only the curve, in less time.
SpaceCurve FitCurveOnly(const CurveData& data, double smoothing);

// The interpolating curves with common parameters (ascending from 0 to 1): poles = points * result.
// Cubic with the least integral of |f'''|^2; of a lower degree for fewer than four points.
struct Interpolation {
  int degree = 3;
  Eigen::ArrayXd knots;
  Eigen::MatrixXd poles_from_points;  // n x number of poles
};
Interpolation MakeInterpolation(const Eigen::ArrayXd& parameters);

}  // namespace velamap
