// The normal equations of a marker problem at its solution, and the covariance that follows.
//
// The parameters are the corners of the markers and the globals (poses but the first, intrinsics,
// rolling shutter, inset, print scale, scales of parts), all in their tangent spaces. Only the
// globals couple one marker with another:
//
//   H = |  D   W |   D block-diagonal by marker,    S = B - W^T D^-1 W = L L^T,
//       | W^T  B |   cov(markers) = D^-1 + F F^T,   F = D^-1 W L^-T.

#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "reconstruct/problem/marker_problem.h"

namespace velamap {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Derivatives of one residual block, one row for each residual.
struct ResidualJacobian {
  int marker_idx = -1;  // -1: depends on no marker
  RowMajorMatrix by_marker;
  // By consecutive globals: index of the first one, derivatives.
  std::vector<std::pair<int, RowMajorMatrix>> by_globals;

  Eigen::Index NumRows() const {
    return marker_idx >= 0 ? by_marker.rows() : by_globals.front().second.rows();
  }
};

// Derivatives of corners and priors. Scale bars, which would couple markers, are not part of it.
struct MarkerJacobian {
  std::vector<ResidualJacobian> corners;  // by corner_residuals of the problem
  std::vector<ResidualJacobian> priors;   // by prior_residuals
  std::vector<Eigen::Index> begins;       // first parameter of each marker, and the end
  int num_globals = 0;
};
MarkerJacobian EvaluateJacobian(const MarkerProblem& problem);

struct MarkerCovariance {
  std::vector<Eigen::MatrixXd> marker_blocks;  // D^-1
  std::vector<Eigen::Index> begins;            // first row of each marker in F, and the end
  RowMajorMatrix factor;                       // F
  Eigen::MatrixXd root;                        // L, lower triangular

  auto FactorOf(std::size_t marker_idx) const {
    return factor.middleRows(begins[marker_idx], begins[marker_idx + 1] - begins[marker_idx]);
  }
};

// Returns nothing if the data leave a combination of parameters undetermined. Runs on up to
// `num_threads` threads (0: one per core), which do not change the result.
std::optional<MarkerCovariance> InvertNormalEquations(const MarkerJacobian& jacobian,
                                                      int num_threads);

// Columns of parameters, one for each case.
struct ParameterColumns {
  RowMajorMatrix of_points, of_globals;
};

// The least-squares step for `errors` of all residuals, one row for each residual (corners, then
// priors) and one column for each case: covariance * J^T errors.
ParameterColumns LeastSquaresStep(const MarkerJacobian& jacobian,
                                  const MarkerCovariance& covariance, const RowMajorMatrix& errors);

// What remains of the errors in the residuals after the step of LeastSquaresStep().
RowMajorMatrix ErrorsLeft(const MarkerJacobian& jacobian, const MarkerCovariance& covariance,
                          const RowMajorMatrix& errors);

// Building blocks of LeastSquaresStep() and ErrorsLeft(). AddGradient() adds J^T errors of one
// residual block, whose rows begin at `row`, to the columns from `column` on.
// MultiplyByCovariance() multiplies all columns by the covariance.
void AddGradient(const ResidualJacobian& block, const MarkerCovariance& covariance,
                 const RowMajorMatrix& errors, Eigen::Index row, Eigen::Index column,
                 ParameterColumns* gradient);
void MultiplyByCovariance(const MarkerCovariance& covariance, ParameterColumns* columns);
ParameterColumns ZeroColumns(const MarkerCovariance& covariance, Eigen::Index num_columns);

// Sum of the variances of the predicted residuals of one block.
double Leverage(const MarkerCovariance& covariance, const ResidualJacobian& jacobian);

}  // namespace velamap
