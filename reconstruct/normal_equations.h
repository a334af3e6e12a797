// The normal equations of a marker problem at its solution, and the covariance that follows.
// Private to this room: it shows Ceres.
//
// Parameters are the markers' corners and the globals (cameras but the first, inset, print scale,
// intrinsics, velocities; tangent spaces). Only globals couple one marker with another:
//
//   H = | D  W |   D block-diagonal by marker,    S = B - W^T D^-1 W = L L^T,
//       | W' B |   cov(markers) = D^-1 + F F^T,   F = D^-1 W L^-T.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "reconstruct/marker_problem.h"
#include "reconstruct/point_covariance.h"

namespace velamap {

struct NormalEquations {
  std::vector<Eigen::MatrixXd> marker_blocks;  // D, by marker
  std::vector<Eigen::MatrixXd> coupling;       // W, rows of each marker
  Eigen::MatrixXd globals;                     // B
};

// Jacobian rows of some residual blocks. A row touches one marker at most.
struct JacobianRow {
  int marker_idx = -1;
  Eigen::VectorXd by_marker;
  std::vector<std::pair<int, double>> by_globals;  // column, value
};
std::vector<JacobianRow> JacobianRows(const MarkerProblem& problem,
                                      const std::vector<int>& residual_idxs);

// With corners and priors only: no residual has two markers, all are eliminated.
SchurProblem WithoutScaleBars(const MarkerProblem& problem);

// Of corners and priors; not of scale bars.
NormalEquations MakeNormalEquations(const MarkerProblem& problem);

struct MarkerCovariance {
  std::vector<Eigen::MatrixXd> marker_blocks;  // D^-1
  std::vector<Eigen::MatrixXd> factors;        // F, rows of each marker
  Eigen::MatrixXd root;                        // L, lower triangular
};

// Nothing where the data leave a combination of parameters undetermined.
std::optional<MarkerCovariance> Invert(const NormalEquations& equations);

// Variance of the prediction of an observation with this row.
double Leverage(const MarkerCovariance& covariance, const JacobianRow& row);

// Columns of the globals' covariance for one parameter block's first `size` columns at `begin`.
Eigen::MatrixXd GlobalCovariance(const MarkerCovariance& covariance, int begin, int size);

}  // namespace velamap
