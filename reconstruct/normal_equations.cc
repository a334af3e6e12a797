#include "reconstruct/normal_equations.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "importer/error.h"

namespace velamap {

SchurProblem WithoutScaleBars(const MarkerProblem& problem) {
  const std::size_t num_residuals =
      problem.corner_residuals.size() + problem.prior_residuals.size();
  const auto& residuals = problem.schur.residuals;
  return {problem.schur.blocks,
          {residuals.begin(), residuals.begin() + static_cast<std::ptrdiff_t>(num_residuals)}};
}

std::vector<JacobianRow> JacobianRows(const MarkerProblem& problem,
                                      const std::vector<int>& residual_idxs) {
  const SchurStructure structure = MakeSchurStructure(WithoutScaleBars(problem));
  std::vector<JacobianRow> rows;
  const auto add_rows = [&](const SchurResidual& residual, const Eigen::VectorXd& residuals,
                            const std::vector<SchurSystem::RowMajor>& jacobians) {
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {
      JacobianRow row;
      for (std::size_t k = 0; k < residual.block_idxs.size(); ++k) {
        const int block_idx = residual.block_idxs[k];
        const int column = structure.column_of_block[static_cast<std::size_t>(block_idx)];
        if (block_idx < problem.num_markers) {
          row.marker_idx = block_idx;
          row.by_marker = jacobians[k].row(i);
        } else if (column >= 0) {
          for (Eigen::Index j = 0; j < jacobians[k].cols(); ++j) {
            row.by_globals.emplace_back(column + static_cast<int>(j), jacobians[k](i, j));
          }
        }
      }
      rows.push_back(std::move(row));
    }
  };
  VELAMAP_CHECK(VisitResiduals(problem.schur, residual_idxs, true, add_rows));
  return rows;
}

NormalEquations MakeNormalEquations(const MarkerProblem& problem) {
  const SchurProblem schur = WithoutScaleBars(problem);
  const SchurStructure structure = MakeSchurStructure(schur);
  SchurSystem system;
  VELAMAP_CHECK(Linearise(schur, structure, &system));
  NormalEquations equations;
  equations.globals = system.kept_hessian;
  for (std::size_t i = 0; i < system.eliminated.size(); ++i) {
    const SchurSystem::Eliminated& eliminated = system.eliminated[i];
    equations.marker_blocks.emplace_back(eliminated.hessian);
    Eigen::MatrixXd coupling =
        Eigen::MatrixXd::Zero(eliminated.hessian.rows(), structure.num_kept_columns);
    Eigen::Index from = 0;
    for (const int block_idx : structure.eliminated[i].kept_block_idxs) {
      const int size = schur.blocks[static_cast<std::size_t>(block_idx)].TangentSize();
      coupling.middleCols(structure.column_of_block[static_cast<std::size_t>(block_idx)], size) =
          eliminated.coupling.middleCols(from, size);
      from += size;
    }
    equations.coupling.push_back(std::move(coupling));
  }
  return equations;
}

std::optional<MarkerCovariance> Invert(const NormalEquations& equations) {
  const std::size_t num_markers = equations.marker_blocks.size();
  MarkerCovariance covariance;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots(num_markers);
  Eigen::MatrixXd schur = equations.globals;
  std::vector<Eigen::MatrixXd>& factors = covariance.factors;
  for (std::size_t i = 0; i < num_markers; ++i) {
    roots[i].compute(equations.marker_blocks[i]);
    if (roots[i].info() != Eigen::Success) return std::nullopt;
    factors.push_back(roots[i].matrixL().solve(equations.coupling[i]));
    schur.selfadjointView<Eigen::Lower>().rankUpdate(factors[i].transpose(), -1.0);
  }
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
    const Eigen::Index size = factors[i].rows();
    covariance.marker_blocks.push_back(roots[i].solve(Eigen::MatrixXd::Identity(size, size)));
    roots[i].matrixU().solveInPlace(factors[i]);
    covariance.root.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(
        factors[i]);
  }
  return covariance;
}

double Leverage(const MarkerCovariance& covariance, const JacobianRow& row) {
  Eigen::VectorXd by_globals = Eigen::VectorXd::Zero(covariance.root.rows());
  for (const auto& [column, value] : row.by_globals) by_globals[column] += value;
  covariance.root.triangularView<Eigen::Lower>().solveInPlace(by_globals);
  if (row.marker_idx < 0) return by_globals.squaredNorm();
  // cov(marker, globals) = -F L^-1.
  const Eigen::MatrixXd& factor = covariance.factors[row.marker_idx];
  return row.by_marker.dot(covariance.marker_blocks[row.marker_idx] * row.by_marker) +
         (factor.transpose() * row.by_marker - by_globals).squaredNorm();
}

Eigen::MatrixXd GlobalCovariance(const MarkerCovariance& covariance, int begin, int size) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(covariance.root.rows(), size);
  columns.middleRows(begin, size).setIdentity();
  covariance.root.triangularView<Eigen::Lower>().solveInPlace(columns);
  return columns.transpose() * columns;
}

}  // namespace velamap
