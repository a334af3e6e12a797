#include "exporters/curve/section_spline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <unsupported/Eigen/KroneckerProduct>

#include "exporters/formats/surface_spline.h"
#include "exporters/shape/shape_sigma.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

constexpr double kMinSigma_m = 1e-6;
constexpr int kCubic = 3;

// Rows whose products with the poles have squares that sum to the integral of |f'''|^2. The third
// derivative is constant within a knot span.
Eigen::MatrixXd ThirdDerivativeRows(const Eigen::ArrayXd& knots) {
  const Eigen::Index num_poles = knots.size() - kCubic - 1;
  Eigen::MatrixXd rows(num_poles - kCubic, num_poles);
  for (Eigen::Index span = 0; span < rows.rows(); ++span) {
    const double begin = knots[span + kCubic], length = knots[span + kCubic + 1] - begin;
    rows.row(span) =
        std::sqrt(length) * BasisRow(knots, kCubic, begin + length / 2, kCubic).row(kCubic);
  }
  return rows;
}

// Whitened least squares |design * poles - values|^2 + lambda |penalty * poles|^2.
struct Smoother {
  Eigen::MatrixXd design, penalty;
  Eigen::VectorXd values;
  Eigen::Vector3d origin;  // of the values, for numerical precision
  Eigen::ArrayXd knots, parameters;
  bool is_noise_known = false;
};

Smoother MakeSmoother(const CurveData& data) {
  const Eigen::Matrix3Xd& points = data.points_in_shape_m;
  VELAMAP_CHECK(points.cols() > kCubic);
  Smoother smoother;
  smoother.parameters = ChordLengthParameters(points);
  smoother.knots = KnotsAt(smoother.parameters, kCubic);
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  smoother.design =
      Eigen::kroneckerProduct(BasisValues(smoother.knots, kCubic, smoother.parameters), identity);
  smoother.origin = points.col(0);
  const Eigen::Matrix3Xd relative = points.colwise() - smoother.origin;
  smoother.values = Eigen::Map<const Eigen::VectorXd>(relative.data(), relative.size());
  smoother.is_noise_known = data.covariance_m2.size() > 0;
  if (smoother.is_noise_known) {
    VELAMAP_CHECK(data.covariance_m2.rows() == relative.size());
    const Eigen::MatrixXd noise =
        data.covariance_m2 +
        kMinSigma_m * kMinSigma_m * Eigen::MatrixXd::Identity(relative.size(), relative.size());
    const Eigen::LLT<Eigen::MatrixXd> root(noise);
    VELAMAP_CHECK(root.info() == Eigen::Success);
    root.matrixL().solveInPlace(smoother.design);
    root.matrixL().solveInPlace(smoother.values);
  }
  const Eigen::MatrixXd third = ThirdDerivativeRows(smoother.knots);
  // Gives points and penalty equal weight; lambda is relative to this.
  smoother.penalty = smoother.design.norm() / (std::sqrt(3.0) * third.norm()) *
                     Eigen::kroneckerProduct(third, identity).eval();
  return smoother;
}

// QR decomposition of design over penalty, which is better conditioned than the normal equations.
Eigen::HouseholderQR<Eigen::MatrixXd> Decompose(const Smoother& smoother, double smoothing) {
  Eigen::MatrixXd stacked(smoother.design.rows() + smoother.penalty.rows(), smoother.design.cols());
  stacked << smoother.design, std::sqrt(smoothing) * smoother.penalty;
  return stacked.householderQr();
}

Eigen::VectorXd SolvePoles(const Smoother& smoother,
                           const Eigen::HouseholderQR<Eigen::MatrixXd>& qr) {
  Eigen::VectorXd right = Eigen::VectorXd::Zero(qr.rows());
  right.head(smoother.values.size()) = smoother.values;
  return qr.solve(right);
}

// Trace of the hat matrix: sum of the squares of Q over the rows of the points.
double HatTrace(const Smoother& smoother, const Eigen::HouseholderQR<Eigen::MatrixXd>& qr) {
  const Eigen::MatrixXd columns =
      qr.householderQ() * Eigen::MatrixXd::Identity(qr.rows(), qr.cols());
  return columns.topRows(smoother.values.size()).squaredNorm();
}

SpaceCurve CurveFromPoles(const Smoother& smoother, const Eigen::VectorXd& poles) {
  SpaceCurve curve;
  curve.degree = kCubic;
  curve.knots = smoother.knots;
  curve.poles_in_shape_m =
      Eigen::Map<const Eigen::Matrix3Xd>(poles.data(), 3, poles.size() / 3).colwise() +
      smoother.origin;
  return curve;
}

// Mallows' Cp or the cross-validation error of all curves together; lower is better.
double Score(const std::vector<Smoother>& smoothers, double smoothing) {
  double residual = 0.0, trace = 0.0, num_values = 0.0;
  for (const Smoother& smoother : smoothers) {
    const auto qr = Decompose(smoother, smoothing);
    residual += (smoother.design * SolvePoles(smoother, qr) - smoother.values).squaredNorm();
    trace += HatTrace(smoother, qr);
    num_values += static_cast<double>(smoother.values.size());
  }
  if (smoothers.front().is_noise_known) return residual + 2 * trace;
  // A noise of at least a micrometre keeps rounding from deciding for exact points.
  residual += num_values * kMinSigma_m * kMinSigma_m;
  return residual / std::pow(std::max(num_values - trace, 1e-9), 2);
}

// The curves whose points decide on the smoothing. Without sigmas, a curve of four points has no
// vote: a parabola leaves one residual per axis, and its cross-validation error is the same for
// every smoothing. If all curves are so short, all get a nominal sigma.
std::vector<CurveData> VotersAmong(const std::vector<CurveData>& curves) {
  if (curves.front().covariance_m2.size() > 0) return curves;
  std::vector<CurveData> voters;
  Eigen::Matrix3Xd all_points(3, 0);
  for (const CurveData& curve : curves) {
    const Eigen::Matrix3Xd& points = curve.points_in_shape_m;
    if (points.cols() > kCubic + 1) voters.push_back(curve);
    all_points.conservativeResize(Eigen::NoChange, all_points.cols() + points.cols());
    all_points.rightCols(points.cols()) = points;
  }
  if (!voters.empty()) return voters;
  const double variance_m2 = std::pow(NominalSigma(all_points), 2);
  for (CurveData curve : curves) {
    const Eigen::Index num_values = curve.points_in_shape_m.size();
    curve.covariance_m2 = variance_m2 * Eigen::MatrixXd::Identity(num_values, num_values);
    voters.push_back(curve);
  }
  return voters;
}

}  // namespace

Eigen::ArrayXd ChordLengthParameters(const Eigen::Matrix3Xd& points) {
  VELAMAP_CHECK(points.cols() >= 2);
  Eigen::ArrayXd parameters(points.cols());
  parameters[0] = 0.0;
  for (Eigen::Index i = 1; i < points.cols(); ++i) {
    parameters[i] = parameters[i - 1] + (points.col(i) - points.col(i - 1)).norm();
    VELAMAP_CHECK(parameters[i] > parameters[i - 1]);
  }
  return parameters / parameters[parameters.size() - 1];
}

double ChooseSmoothing(const std::vector<CurveData>& curves) {
  constexpr int kFirst = -16, kLast = 16;  // from interpolation to parabolas
  constexpr double kStepsPerDecade = 2.0;
  // The optimum for the points oversmooths their derivatives, and so angles and draft. With a tenth
  // of it, their bias on smooth sections stays below their noise.
  constexpr double kShare = 0.1;
  VELAMAP_CHECK(!curves.empty());
  std::vector<Smoother> smoothers;
  for (const CurveData& curve : VotersAmong(curves)) smoothers.push_back(MakeSmoother(curve));
  double best = 0.0, best_score = std::numeric_limits<double>::infinity();
  for (int step = kFirst; step <= kLast; ++step) {
    const double smoothing = std::pow(10.0, step / kStepsPerDecade);
    const double score = Score(smoothers, smoothing);
    if (score >= best_score) continue;
    best = smoothing;
    best_score = score;
  }
  return kShare * best;
}

CurveFit FitCurve(const CurveData& data, double smoothing) {
  const Smoother smoother = MakeSmoother(data);
  const auto qr = Decompose(smoother, smoothing);
  return {CurveFromPoles(smoother, SolvePoles(smoother, qr)), smoother.parameters,
          HatTrace(smoother, qr) / 3};
}

SpaceCurve FitCurveOnly(const CurveData& data, double smoothing) {
  const Smoother smoother = MakeSmoother(data);
  return CurveFromPoles(smoother, SolvePoles(smoother, Decompose(smoother, smoothing)));
}

Interpolation MakeInterpolation(const Eigen::ArrayXd& parameters) {
  const Eigen::Index num_points = parameters.size();
  VELAMAP_CHECK(num_points >= 2);
  Interpolation result;
  result.degree = static_cast<int>(std::min<Eigen::Index>(kCubic, num_points - 1));
  if (result.degree < kCubic) {  // one polynomial
    result.knots = KnotsAt(parameters.head(1), result.degree);
    result.poles_from_points =
        BasisValues(result.knots, result.degree, parameters).inverse().transpose();
    return result;
  }
  // Minimizes the penalty with the points as constraints by Lagrange multipliers:
  // [penalty  design^T; design  0] [poles; multipliers] = [0; points].
  result.knots = KnotsAt(parameters, kCubic);
  const Eigen::MatrixXd design = BasisValues(result.knots, kCubic, parameters);
  const Eigen::MatrixXd third = ThirdDerivativeRows(result.knots);
  const Eigen::MatrixXd penalty = third.transpose() * third;
  const Eigen::Index num_poles = design.cols();
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(num_poles + num_points, num_poles + num_points);
  system.topLeftCorner(num_poles, num_poles) = penalty / penalty.trace();
  system.topRightCorner(num_poles, num_points) = design.transpose();
  system.bottomLeftCorner(num_points, num_poles) = design;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(num_poles + num_points, num_points);
  right.bottomRows(num_points).setIdentity();
  result.poles_from_points = system.partialPivLu().solve(right).topRows(num_poles).transpose();
  return result;
}

}  // namespace velamap
