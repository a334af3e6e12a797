#include "exporters/curve/space_curve.h"

#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "exporters/formats/surface_spline.h"

namespace velamap {
namespace {

// The step of the parameter after which a curve that leaves with these derivatives is this long.
double StepOfLength(const Eigen::Vector3d& x_t, const Eigen::Vector3d& x_tt, double length_m) {
  constexpr int kNumRounds = 4;
  if (length_m == 0) return 0.0;
  double step = length_m / x_t.norm();
  for (int round = 0; round < kNumRounds; ++round) {
    const double found_m = step / 6 *
                           (x_t.norm() + 4 * (x_t + step / 2 * x_tt).norm() +
                            (x_t + step * x_tt).norm());  // Simpson's rule
    step *= length_m / found_m;
  }
  return step;
}

}  // namespace

Eigen::ArrayXd KnotsAt(const Eigen::ArrayXd& parameters, int degree) {
  std::vector<double> interior;
  for (const double t : parameters) {
    if (t > 0 && t < 1) interior.push_back(t);
  }
  const auto num_interior = static_cast<Eigen::Index>(interior.size());
  Eigen::ArrayXd knots(num_interior + 2 * (degree + 1));
  knots.head(degree + 1) = 0.0;
  knots.segment(degree + 1, num_interior) =
      Eigen::Map<const Eigen::ArrayXd>(interior.data(), num_interior);
  knots.tail(degree + 1) = 1.0;
  return knots;
}

Eigen::Vector3d EvaluateCurve(const SpaceCurve& curve, double t) {
  return curve.poles_in_shape_m * BasisRow(curve.knots, curve.degree, t, 0).transpose();
}

CurveJet EvaluateCurveJet(const SpaceCurve& curve, double t) {
  const Eigen::Matrix3d jet =
      curve.poles_in_shape_m * BasisRow(curve.knots, curve.degree, t, 2).transpose();
  return {jet.col(0), jet.col(1), jet.col(2)};
}

SpaceCurve ExtendCurve(const SpaceCurve& curve, const CurveEnds& ends) {
  if (ends.before_m == 0 && ends.after_m == 0) return curve;
  const CurveJet first = EvaluateCurveJet(curve, 0.0), last = EvaluateCurveJet(curve, 1.0);
  const double begin = -StepOfLength(-first.x_t, first.x_tt, ends.before_m);
  const double end = 1.0 + StepOfLength(last.x_t, last.x_tt, ends.after_m);
  const auto evaluate = [&](double t) -> Eigen::Vector3d {
    if (t < 0) return first.x + t * first.x_t + t * t / 2 * first.x_tt;
    if (t > 1) return last.x + (t - 1) * last.x_t + (t - 1) * (t - 1) / 2 * last.x_tt;
    return EvaluateCurve(curve, t);
  };
  // The old ends become knots, where only the third derivative jumps.
  const Eigen::Index num_interior = curve.knots.size() - 2 * (curve.degree + 1);
  Eigen::ArrayXd inner(num_interior + 2);
  inner << 0.0, curve.knots.segment(curve.degree + 1, num_interior), 1.0;
  const Eigen::ArrayXd new_knots = KnotsAt((inner - begin) / (end - begin), curve.degree);
  SpaceCurve extended{curve.degree, new_knots, {}};
  const Eigen::Index num_poles = new_knots.size() - curve.degree - 1;
  Eigen::ArrayXd places(num_poles);  // Greville's abscissae
  Eigen::Matrix3Xd points(3, num_poles);
  for (Eigen::Index i = 0; i < num_poles; ++i) {
    places[i] = new_knots.segment(i + 1, curve.degree).mean();
    points.col(i) = evaluate(begin + places[i] * (end - begin));
  }
  extended.poles_in_shape_m = BasisValues(new_knots, curve.degree, places)
                                  .partialPivLu()
                                  .solve(points.transpose())
                                  .transpose();
  return extended;
}

double CurvatureChange(const SpaceCurve& curve, const Eigen::Vector3d& direction) {
  double sum = 0.0;
  for (const QuadratureNode& node : SpanQuadrature(curve.knots)) {
    const Eigen::MatrixXd rows = BasisRow(curve.knots, curve.degree, node.parameter, 3);
    const double change = direction.dot(curve.poles_in_shape_m * rows.row(3).transpose());
    const double speed_m = (curve.poles_in_shape_m * rows.row(1).transpose()).norm();
    sum += node.weight * std::pow(change / std::pow(speed_m, 3), 2);
  }
  return std::sqrt(sum);
}

Eigen::Vector3d ChordOf(const SpaceCurve& curve) {
  return EvaluateCurve(curve, 1.0) - EvaluateCurve(curve, 0.0);
}

double MiddleHeight(const SpaceCurve& curve, const Eigen::Vector3d& up) {
  return up.dot(EvaluateCurve(curve, 0.0) + EvaluateCurve(curve, 1.0)) / 2;
}

double ParameterAtHeight(const SpaceCurve& curve, const Eigen::Vector3d& up, double height_m) {
  constexpr int kMaxSteps = 60;
  double low = 0.0, high = 1.0, t = 0.5;
  for (int step = 0; step < kMaxSteps; ++step) {
    const CurveJet jet = EvaluateCurveJet(curve, t);
    const double excess_m = up.dot(jet.x) - height_m;
    (excess_m < 0 ? low : high) = t;
    const double newton = t - excess_m / up.dot(jet.x_t);
    const double next = newton >= low && newton <= high ? newton : 0.5 * (low + high);
    if (std::abs(next - t) < 1e-13) return next;
    t = next;
  }
  return t;
}

}  // namespace velamap
