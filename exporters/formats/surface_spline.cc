#include "exporters/formats/surface_spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <unsupported/Eigen/Splines>

namespace velamap {
namespace {

using ScalarSpline = Eigen::Spline<double, 1>;

// sum_ij a_i b_j P_ij
Eigen::Vector3d Combine(const SplineSurface& surface, const Eigen::VectorXd& basis_u,
                        const Eigen::VectorXd& basis_v) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < basis_u.size(); ++i) {
    if (basis_u(i) == 0) continue;
    sum += basis_u(i) *
           surface.poles_in_shape_m.middleRows(i * basis_v.size(), basis_v.size()).transpose() *
           basis_v;
  }
  return sum;
}

// Whether a parameter stays at its bound because the step would leave the domain.
bool IsHeld(double parameter, double gradient) {
  return (parameter <= 0 && gradient < 0) || (parameter >= 1 && gradient > 0);
}

SurfaceFoot RefineFoot(const SplineSurface& surface, const Eigen::Vector3d& x, double u, double v) {
  constexpr int kMaxSteps = 60;
  constexpr double kConverged = 1e-13;
  SurfaceJet jet = EvaluateJet(surface, u, v);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Vector3d rest = x - jet.x;
    const Eigen::Vector2d delta =
        StepToFoot(jet, x, IsHeld(u, jet.x_u.dot(rest)), IsHeld(v, jet.x_v.dot(rest)));
    double next_u = 0, next_v = 0;
    for (double damping = 1; damping > 1e-4; damping /= 2) {
      next_u = std::clamp(u + damping * delta(0), 0.0, 1.0);
      next_v = std::clamp(v + damping * delta(1), 0.0, 1.0);
      jet = EvaluateJet(surface, next_u, next_v);
      if ((x - jet.x).squaredNorm() <= rest.squaredNorm()) break;
    }
    const double moved = std::max(std::abs(next_u - u), std::abs(next_v - v));
    u = next_u;
    v = next_v;
    if (moved < kConverged) break;
  }
  SurfaceFoot foot;
  foot.u = u;
  foot.v = v;
  foot.x_in_shape_m = jet.x;
  const Eigen::Vector3d rest = x - jet.x;
  foot.distance_m = rest.dot(jet.normal);
  const bool at_edge = u <= 0 || u >= 1 || v <= 0 || v >= 1;
  if (at_edge) foot.beyond_edge_m = (rest - foot.distance_m * jet.normal).norm();
  return foot;
}

}  // namespace

Eigen::Vector2d StepToFoot(const SurfaceJet& jet, const Eigen::Vector3d& x_in_shape_m, bool hold_u,
                           bool hold_v) {
  const Eigen::Vector3d rest = x_in_shape_m - jet.x;
  const Eigen::Vector2d gradient(jet.x_u.dot(rest), jet.x_v.dot(rest));
  Eigen::Matrix2d hessian;
  hessian << jet.x_u.squaredNorm(), jet.x_u.dot(jet.x_v), jet.x_u.dot(jet.x_v),
      jet.x_v.squaredNorm();
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  if (!hold_u && !hold_v && hessian.determinant() > 1e-12 * hessian(0, 0) * hessian(1, 1)) {
    step = hessian.inverse() * gradient;
  } else if (!hold_u && hessian(0, 0) > 0) {
    step(0) = gradient(0) / hessian(0, 0);
  } else if (!hold_v && hessian(1, 1) > 0) {
    step(1) = gradient(1) / hessian(1, 1);
  }
  return step;
}

Eigen::MatrixXd BasisRow(const Eigen::ArrayXd& knots, int degree, double parameter, int max_order) {
  Eigen::MatrixXd row = Eigen::MatrixXd::Zero(max_order + 1, knots.size() - degree - 1);
  const ScalarSpline::KnotVectorType knot_row = knots.transpose();
  const int order = std::min(max_order, degree);
  row.block(0, ScalarSpline::Span(parameter, degree, knot_row) - degree, order + 1, degree + 1) =
      ScalarSpline::BasisFunctionDerivatives(parameter, order, degree, knot_row).matrix();
  return row;
}

Eigen::MatrixXd BasisValues(const Eigen::ArrayXd& knots, int degree,
                            const Eigen::ArrayXd& parameters) {
  Eigen::MatrixXd values(parameters.size(), knots.size() - degree - 1);
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    values.row(i) = BasisRow(knots, degree, parameters[i], 0);
  }
  return values;
}

std::vector<double> SpanSamples(const Eigen::ArrayXd& knots) {
  constexpr int kPerSpan = 6;
  std::vector<double> samples = {knots(0)};
  for (Eigen::Index k = 0; k + 1 < knots.size(); ++k) {
    if (knots(k + 1) <= knots(k)) continue;
    for (int i = 1; i <= kPerSpan; ++i) {
      samples.push_back(knots(k) + (knots(k + 1) - knots(k)) * i / kPerSpan);
    }
  }
  return samples;
}

std::vector<QuadratureNode> SpanQuadrature(const Eigen::ArrayXd& knots) {
  constexpr std::array<double, 4> kNodes = {-0.8611363115940526, -0.3399810435848563,
                                            0.3399810435848563, 0.8611363115940526};
  constexpr std::array<double, 4> kWeights = {0.3478548451374538, 0.6521451548625461,
                                              0.6521451548625461, 0.3478548451374538};
  std::vector<QuadratureNode> nodes;
  for (Eigen::Index k = 0; k + 1 < knots.size(); ++k) {
    const double half = (knots(k + 1) - knots(k)) / 2;
    if (half <= 0) continue;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      nodes.push_back({knots(k) + half * (1 + kNodes[i]), half * kWeights[i]});
    }
  }
  return nodes;
}

SurfaceJet EvaluateJet(const SplineSurface& surface, double u, double v) {
  const Eigen::MatrixXd basis_u = BasisRow(surface.knots_u, surface.degree_u, u, 2);
  const Eigen::MatrixXd basis_v = BasisRow(surface.knots_v, surface.degree_v, v, 2);
  const auto derivative = [&](int order_u, int order_v) {
    return Combine(surface, basis_u.row(order_u), basis_v.row(order_v));
  };
  SurfaceJet jet;
  jet.x = derivative(0, 0);
  jet.x_u = derivative(1, 0);
  jet.x_v = derivative(0, 1);
  jet.x_uu = derivative(2, 0);
  jet.x_uv = derivative(1, 1);
  jet.x_vv = derivative(0, 2);
  jet.normal = jet.x_u.cross(jet.x_v);
  const double size = jet.normal.norm();
  if (size > 1e-12 * (jet.x_u.squaredNorm() + jet.x_v.squaredNorm())) {
    jet.normal /= size;
  } else {
    jet.normal.setZero();
  }
  return jet;
}

Eigen::Vector3d EvaluatePoint(const SplineSurface& surface, double u, double v) {
  return Combine(surface, BasisRow(surface.knots_u, surface.degree_u, u, 0).transpose(),
                 BasisRow(surface.knots_v, surface.degree_v, v, 0).transpose());
}

Eigen::Vector3d EvaluateNormal(const SplineSurface& surface, double u, double v) {
  const Eigen::Vector3d normal = EvaluateJet(surface, u, v).normal;
  if (!normal.isZero()) return normal;
  constexpr double kInward = 1e-4;
  return EvaluateJet(surface, u + kInward * (0.5 - u), v + kInward * (0.5 - v)).normal;
}

double SurfaceArea(const SplineSurface& surface) {
  double area_m2 = 0.0;
  const auto nodes_v = SpanQuadrature(surface.knots_v);
  for (const QuadratureNode& node_u : SpanQuadrature(surface.knots_u)) {
    for (const QuadratureNode& node_v : nodes_v) {
      const SurfaceJet jet = EvaluateJet(surface, node_u.parameter, node_v.parameter);
      area_m2 += node_u.weight * node_v.weight * jet.x_u.cross(jet.x_v).norm();
    }
  }
  return area_m2;
}

std::vector<SurfaceFoot> ProjectOnSurface(const SplineSurface& surface,
                                          const std::vector<Eigen::Vector3d>& points_in_shape_m) {
  const std::vector<double> us = SpanSamples(surface.knots_u);
  const std::vector<double> vs = SpanSamples(surface.knots_v);
  const auto array = [](const std::vector<double>& x) {
    return Eigen::Map<const Eigen::ArrayXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  };
  const Eigen::MatrixXd basis_u = BasisValues(surface.knots_u, surface.degree_u, array(us));
  const Eigen::MatrixXd basis_v = BasisValues(surface.knots_v, surface.degree_v, array(vs));
  std::vector<Eigen::Vector3d> samples;
  for (std::size_t i = 0; i < us.size(); ++i) {
    for (std::size_t j = 0; j < vs.size(); ++j) {
      samples.push_back(Combine(surface, basis_u.row(i), basis_v.row(j)));
    }
  }
  std::vector<SurfaceFoot> feet;
  for (const Eigen::Vector3d& x : points_in_shape_m) {
    std::size_t best = 0;
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double distance = (samples[k] - x).squaredNorm();
      if (distance < best_distance) {
        best_distance = distance;
        best = k;
      }
    }
    feet.push_back(RefineFoot(surface, x, us[best / vs.size()], vs[best % vs.size()]));
  }
  return feet;
}

}  // namespace velamap
