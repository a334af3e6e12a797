#include "reconstruct/normal_equations.h"

#include <cmath>

#include <ceres/crs_matrix.h>
#include <Eigen/Cholesky>

#include "importer/error.h"

namespace velamap {
namespace {

// Where the columns of the Jacobian lie.
struct Columns {
  std::vector<int> marker_of;  // by column; -1 for globals
  std::vector<int> first_of;   // by marker
  int first_global = 0;
  int num_globals = 0;
};

Columns FindColumns(const MarkerProblem& problem) {
  Columns columns;
  for (std::size_t i = 0; i < problem.markers.size(); ++i) {
    columns.first_of.push_back(columns.first_global);
    const int size = problem.problem->ParameterBlockTangentSize(problem.markers[i]);
    columns.marker_of.insert(columns.marker_of.end(), size, static_cast<int>(i));
    columns.first_global += size;
  }
  for (double* block : problem.globals) {
    columns.num_globals += problem.problem->ParameterBlockTangentSize(block);
  }
  columns.marker_of.insert(columns.marker_of.end(), columns.num_globals, -1);
  return columns;
}

ceres::CRSMatrix EvaluateJacobian(const MarkerProblem& problem,
                                  const std::vector<ceres::ResidualBlockId>& residuals) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = problem.markers;
  options.parameter_blocks.insert(options.parameter_blocks.end(), problem.globals.begin(),
                                  problem.globals.end());
  options.residual_blocks = residuals;
  options.num_threads = 1;
  ceres::CRSMatrix jacobian;
  VELAMAP_CHECK(problem.problem->Evaluate(options, nullptr, nullptr, nullptr, &jacobian));
  return jacobian;
}

}  // namespace

std::vector<JacobianRow> JacobianRows(const MarkerProblem& problem,
                                      const std::vector<ceres::ResidualBlockId>& residuals) {
  if (residuals.empty()) return {};
  const Columns columns = FindColumns(problem);
  const ceres::CRSMatrix jacobian = EvaluateJacobian(problem, residuals);
  std::vector<JacobianRow> rows(jacobian.num_rows);
  for (int i = 0; i < jacobian.num_rows; ++i) {
    JacobianRow& row = rows[i];
    for (int entry = jacobian.rows[i]; entry < jacobian.rows[i + 1]; ++entry) {
      const int column = jacobian.cols[entry];
      const int marker_idx = columns.marker_of[column];
      if (marker_idx < 0) {
        row.by_globals.emplace_back(column - columns.first_global, jacobian.values[entry]);
        continue;
      }
      if (row.marker_idx < 0) {
        row.marker_idx = marker_idx;
        row.by_marker.setZero(
            problem.problem->ParameterBlockTangentSize(problem.markers[marker_idx]));
      }
      VELAMAP_CHECK(row.marker_idx == marker_idx);
      row.by_marker[column - columns.first_of[marker_idx]] = jacobian.values[entry];
    }
  }
  return rows;
}

NormalEquations MakeNormalEquations(const MarkerProblem& problem) {
  const Columns columns = FindColumns(problem);
  NormalEquations equations;
  for (double* marker : problem.markers) {
    const int size = problem.problem->ParameterBlockTangentSize(marker);
    equations.marker_blocks.push_back(Eigen::MatrixXd::Zero(size, size));
    equations.coupling.push_back(Eigen::MatrixXd::Zero(size, columns.num_globals));
  }
  equations.globals.setZero(columns.num_globals, columns.num_globals);
  for (const auto* residuals : {&problem.corner_residuals, &problem.prior_residuals}) {
    for (const JacobianRow& row : JacobianRows(problem, *residuals)) {
      for (const auto& [column, value] : row.by_globals) {
        for (const auto& [other_column, other_value] : row.by_globals) {
          equations.globals(other_column, column) += value * other_value;
        }
      }
      if (row.marker_idx < 0) continue;
      equations.marker_blocks[row.marker_idx].noalias() +=
          row.by_marker * row.by_marker.transpose();
      for (const auto& [column, value] : row.by_globals) {
        equations.coupling[row.marker_idx].col(column) += value * row.by_marker;
      }
    }
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
