// Cubic B-splines in space, with which sections, luffs and edges are drawn.

#pragma once

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

// Lengths by which a curve continues beyond its first and its last point, m.
struct CurveEnds {
  double before_m = 0.0, after_m = 0.0;
};
// Continues the curve with the second derivative that it has at each end. The parameters of the
// result run from 0 to 1, too.
SpaceCurve ExtendCurve(const SpaceCurve& curve, const CurveEnds& ends);

// Root mean square of the change of the curvature along the direction, 1/m^2.
double CurvatureChange(const SpaceCurve& curve, const Eigen::Vector3d& direction);

Eigen::Vector3d ChordOf(const SpaceCurve& curve);  // from the first to the last point
double MiddleHeight(const SpaceCurve& curve, const Eigen::Vector3d& up);  // of the chord

// The parameter at which a curve reaches the height; it starts below the height and ends above it.
double ParameterAtHeight(const SpaceCurve& curve, const Eigen::Vector3d& up, double height_m);

// Knots of a curve with one at each of the parameters that are between 0 and 1.
Eigen::ArrayXd KnotsAt(const Eigen::ArrayXd& parameters, int degree);

}  // namespace velamap
