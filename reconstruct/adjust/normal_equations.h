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

#include "reconstruct/adjust/marker_problem.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct NormalEquations {
  std::vector<Eigen::MatrixXd> marker_blocks;  // D, by marker
  SchurSystem::RowMajor coupling;              // W
  Eigen::MatrixXd globals;                     // B
};

// Derivatives of one residual block, a row a residual. It touches one marker at most.
struct ResidualJacobian {
  int marker_idx = -1;
  SchurSystem::RowMajor by_marker;
  std::vector<std::pair<int, SchurSystem::RowMajor>> by_globals;  // first column, derivatives
};
std::vector<ResidualJacobian> ResidualJacobians(const MarkerProblem& problem,
                                                const std::vector<int>& residual_idxs);

// With corners and priors only: no residual has two markers, all are eliminated.
SchurProblem WithoutScaleBars(const MarkerProblem& problem);

// Of corners and priors; not of scale bars.
NormalEquations MakeNormalEquations(const MarkerProblem& problem);

struct MarkerCovariance {
  std::vector<Eigen::MatrixXd> marker_blocks;  // D^-1
  std::vector<Eigen::Index> begins;            // first row of each marker in F, and the end
  SchurSystem::RowMajor factor;                // F
  Eigen::MatrixXd root;                        // L, lower triangular

  auto FactorOf(std::size_t marker_idx) const {
    return factor.middleRows(begins[marker_idx], begins[marker_idx + 1] - begins[marker_idx]);
  }
};

// Nothing where the data leave a combination of parameters undetermined.
std::optional<MarkerCovariance> Invert(const NormalEquations& equations);

// Sum of the variances of the predictions of the observations with these rows.
double Leverage(const MarkerCovariance& covariance, const ResidualJacobian& jacobian);

}  // namespace velamap
