#include "reconstruct/adjust/normal_equations.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "importer/base/error.h"
#include "reconstruct/solve/gram_matrix.h"

namespace velamap {

SchurProblem WithoutScaleBars(const MarkerProblem& problem) {
  const std::size_t num_residuals =
      problem.corner_residuals.size() + problem.prior_residuals.size();
  const auto& residuals = problem.schur.residuals;
  return {problem.schur.blocks,
          {residuals.begin(), residuals.begin() + static_cast<std::ptrdiff_t>(num_residuals)}};
}

std::vector<ResidualJacobian> ResidualJacobians(const MarkerProblem& problem,
                                                const std::vector<int>& residual_idxs) {
  const SchurStructure structure = MakeSchurStructure(WithoutScaleBars(problem));
  std::vector<ResidualJacobian> result;
  result.reserve(residual_idxs.size());
  const auto add = [&](const SchurResidual& residual, const Eigen::VectorXd&,
                       const std::vector<SchurSystem::RowMajor>& jacobians) {
    ResidualJacobian& of_residual = result.emplace_back();
    for (std::size_t k = 0; k < residual.block_idxs.size(); ++k) {
      const int block_idx = residual.block_idxs[k];
      const int column = structure.column_of_block[static_cast<std::size_t>(block_idx)];
      if (block_idx < problem.num_markers) {
        of_residual.marker_idx = block_idx;
        of_residual.by_marker = jacobians[k];
      } else if (column >= 0) {
        of_residual.by_globals.emplace_back(column, jacobians[k]);
      }
    }
  };
  VELAMAP_CHECK(VisitResiduals(problem.schur, residual_idxs, true, add));
  return result;
}

NormalEquations MakeNormalEquations(const MarkerProblem& problem) {
  const SchurProblem schur = WithoutScaleBars(problem);
  const SchurStructure structure = MakeSchurStructure(schur);
  SchurSystem system;
  VELAMAP_CHECK(Linearise(schur, structure, &system));
  NormalEquations equations;
  equations.globals = system.kept_hessian;
  Eigen::Index num_rows = 0;
  for (const SchurSystem::Eliminated& eliminated : system.eliminated) {
    equations.marker_blocks.emplace_back(eliminated.hessian);
    num_rows += eliminated.hessian.rows();
  }
  equations.coupling.setZero(num_rows, structure.num_kept_columns);
  Eigen::Index begin = 0;
  for (std::size_t i = 0; i < system.eliminated.size(); ++i) {
    const SchurSystem::RowMajor& coupling = system.eliminated[i].coupling;
    Eigen::Index from = 0;
    for (const int block_idx : structure.eliminated[i].kept_block_idxs) {
      const int size = schur.blocks[static_cast<std::size_t>(block_idx)].TangentSize();
      equations.coupling.block(begin,
                               structure.column_of_block[static_cast<std::size_t>(block_idx)],
                               coupling.rows(), size) = coupling.middleCols(from, size);
      from += size;
    }
    begin += coupling.rows();
  }
  return equations;
}

std::optional<MarkerCovariance> Invert(const NormalEquations& equations) {
  const std::size_t num_markers = equations.marker_blocks.size();
  MarkerCovariance covariance;
  covariance.begins.push_back(0);
  covariance.factor = equations.coupling;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots(num_markers);
  const auto rows_of = [&covariance](std::size_t i) {
    const Eigen::Index begin = covariance.begins[i];
    return covariance.factor.middleRows(begin, covariance.begins[i + 1] - begin);
  };
  for (std::size_t i = 0; i < num_markers; ++i) {
    covariance.begins.push_back(covariance.begins.back() + equations.marker_blocks[i].rows());
    roots[i].compute(equations.marker_blocks[i]);
    if (roots[i].info() != Eigen::Success) return std::nullopt;
    auto rows = rows_of(i);
    roots[i].matrixL().solveInPlace(rows);
  }
  Eigen::MatrixXd schur = equations.globals;
  SubtractGramMatrix(covariance.factor, &schur);
  // Of all sizes on the diagonal one scale, so that the test below means something.
  const Eigen::LLT<Eigen::MatrixXd> root(schur.selfadjointView<Eigen::Lower>());
  if (root.info() != Eigen::Success) return std::nullopt;
  covariance.root = root.matrixL();
  constexpr double kMinShareOfInformation = 1e-14;
  for (Eigen::Index i = 0; i < schur.rows(); ++i) {
    const double left = covariance.root(i, i) * covariance.root(i, i);
    if (!(left > kMinShareOfInformation * equations.globals(i, i))) return std::nullopt;
  }
  for (std::size_t i = 0; i < num_markers; ++i) {
    auto rows = rows_of(i);
    covariance.marker_blocks.push_back(
        roots[i].solve(Eigen::MatrixXd::Identity(rows.rows(), rows.rows())));
    roots[i].matrixU().solveInPlace(rows);
  }
  SolveTransposedOnTheRight(covariance.root, &covariance.factor);
  return covariance;
}

double Leverage(const MarkerCovariance& covariance, const ResidualJacobian& jacobian) {
  const Eigen::Index num_globals = covariance.root.rows();
  Eigen::Index num_rows = jacobian.by_marker.rows(), first = num_globals;
  for (const auto& [column, derivatives] : jacobian.by_globals) {
    num_rows = derivatives.rows();
    first = std::min<Eigen::Index>(first, column);
  }
  // L^-1 by_globals^T, which is zero where by_globals begins with zeros.
  Eigen::MatrixXd by_globals = Eigen::MatrixXd::Zero(num_globals, num_rows);
  for (const auto& [column, derivatives] : jacobian.by_globals) {
    by_globals.middleRows(column, derivatives.cols()) += derivatives.transpose();
  }
  const Eigen::Index num_left = num_globals - first;
  auto left = by_globals.bottomRows(num_left);
  covariance.root.bottomRightCorner(num_left, num_left)
      .triangularView<Eigen::Lower>()
      .solveInPlace(left);
  if (jacobian.marker_idx < 0) return by_globals.squaredNorm();
  // cov(marker, globals) = -F L^-1.
  const std::size_t marker_idx = static_cast<std::size_t>(jacobian.marker_idx);
  by_globals -= covariance.FactorOf(marker_idx).transpose() * jacobian.by_marker.transpose();
  return jacobian.by_marker.cwiseProduct(jacobian.by_marker * covariance.marker_blocks[marker_idx])
             .sum() +
         by_globals.squaredNorm();
}

}  // namespace velamap
