// A tensor-product B-spline surface: points, derivatives, area and nearest points.
// Eigen evaluates the basis functions (de Boor's recursion; Piegl and Tiller, The NURBS Book, 1997,
// chapter 2).
//
//   S(u, v) = sum_ij N_i(u) M_j(v) P_ij,   0 <= u, v <= 1
//
// On a sail u runs from luff to leech and v from foot to head. The normal is along S_u x S_v: it
// points to a viewer who sees the luff on the left and the foot below.

#pragma once

#include <vector>

#include <Eigen/Core>

namespace velamap {

struct SplineSurface {
  int degree_u = 3;
  int degree_v = 3;
  // With multiplicities: degree + 1 times 0, interior knots ascending, degree + 1 times 1.
  Eigen::ArrayXd knots_u;
  Eigen::ArrayXd knots_v;
  Eigen::MatrixX3d poles_in_shape_m;  // P_ij in row i * NumPolesV() + j

  int NumPolesU() const { return static_cast<int>(knots_u.size()) - degree_u - 1; }
  int NumPolesV() const { return static_cast<int>(knots_v.size()) - degree_v - 1; }
};

// Values of all basis functions and of their derivatives up to `max_order` at one parameter: one
// row per order, one column per pole. Orders above the degree are zero.
Eigen::MatrixXd BasisRow(const Eigen::ArrayXd& knots, int degree, double parameter, int max_order);

// The values alone, one row per parameter.
Eigen::MatrixXd BasisValues(const Eigen::ArrayXd& knots, int degree,
                            const Eigen::ArrayXd& parameters);

// Equidistant parameters that sample the whole surface: six steps in each knot span.
std::vector<double> SpanSamples(const Eigen::ArrayXd& knots);

// Four Gauss-Legendre nodes per knot span, which integrate products of two cubics exactly.
struct QuadratureNode {
  double parameter = 0.0;
  double weight = 0.0;
};
std::vector<QuadratureNode> SpanQuadrature(const Eigen::ArrayXd& knots);

struct SurfaceJet {
  Eigen::Vector3d x, x_u, x_v, x_uu, x_uv, x_vv;  // m, and per unit of parameter
  Eigen::Vector3d normal;                         // unit; zero if S_u x S_v vanishes
};
SurfaceJet EvaluateJet(const SplineSurface& surface, double u, double v);
Eigen::Vector3d EvaluatePoint(const SplineSurface& surface, double u, double v);
// Unit length. If the surface degenerates to a point, the normal of a neighbouring point.
Eigen::Vector3d EvaluateNormal(const SplineSurface& surface, double u, double v);

double SurfaceArea(const SplineSurface& surface);  // m^2

// The Gauss-Newton step of u and v from the point of the jet towards the foot of x: the point of
// the surface whose normal passes through x. A parameter that is held does not move.
Eigen::Vector2d StepToFoot(const SurfaceJet& jet, const Eigen::Vector3d& x_in_shape_m,
                           bool hold_u = false, bool hold_v = false);

struct SurfaceFoot {
  double u = 0.0, v = 0.0;
  Eigen::Vector3d x_in_shape_m = Eigen::Vector3d::Zero();  // nearest point of the surface
  double distance_m = 0.0;                                 // signed, from there along the normal
  double beyond_edge_m = 0.0;  // distance within the tangent plane; 0 unless at an edge
};

// Nearest points of the surface: the nearest point of a dense grid, refined by Gauss-Newton steps.
std::vector<SurfaceFoot> ProjectOnSurface(const SplineSurface& surface,
                                          const std::vector<Eigen::Vector3d>& points_in_shape_m);

}  // namespace velamap
