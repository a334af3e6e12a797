#include "reconstruct/problem/normal_equations.h"

#include <algorithm>
#include <atomic>

#include <ceres/cost_function.h>
#include <ceres/crs_matrix.h>
#include <Eigen/Cholesky>

#include "importer/base/error.h"
#include "importer/base/parallel.h"

namespace velamap {
namespace {

// Work is divided into panels of this many columns or rows, regardless of the number of threads, so
// that all sums are formed in the same order.
constexpr Eigen::Index kPanelSize = 64;

template <typename Work>
void ForEachPanel(Eigen::Index size, int num_threads, const Work& work) {
  const auto num_panels = static_cast<std::size_t>((size + kPanelSize - 1) / kPanelSize);
  ParallelFor(num_panels, num_threads, [&](std::size_t panel) {
    const Eigen::Index begin = static_cast<Eigen::Index>(panel) * kPanelSize;
    work(begin, std::min(kPanelSize, size - begin));
  });
}

// Splits the rows of one residual block, whose columns `cols` are ascending, by marker and globals.
// `marker_of_column` ends where the globals begin.
ResidualJacobian SplitColumns(const Eigen::Map<const RowMajorMatrix>& derivatives, const int* cols,
                              const std::vector<int>& marker_of_column) {
  const int num_marker_columns = static_cast<int>(marker_of_column.size());
  ResidualJacobian jacobian;
  for (Eigen::Index begin = 0, end = 0; begin < derivatives.cols(); begin = end) {
    const int first = cols[begin];
    end = begin + 1;
    while (end < derivatives.cols() && cols[end] == cols[end - 1] + 1 &&
           cols[end] != num_marker_columns) {
      ++end;
    }
    const auto part = derivatives.middleCols(begin, end - begin);
    if (first < num_marker_columns) {
      jacobian.marker_idx = marker_of_column[static_cast<std::size_t>(first)];
      jacobian.by_marker = part;
    } else {
      jacobian.by_globals.emplace_back(first - num_marker_columns, part);
    }
  }
  return jacobian;
}

// Sums of products of derivatives: D and W by marker, and the lower triangle of B.
struct NormalMatrix {
  std::vector<Eigen::MatrixXd> marker_blocks;  // D
  RowMajorMatrix coupling;                     // W
  Eigen::MatrixXd globals;                     // B
};

NormalMatrix SumProducts(const MarkerJacobian& jacobian, int num_threads) {
  const std::size_t num_markers = jacobian.begins.size() - 1;
  NormalMatrix normal;
  normal.marker_blocks.resize(num_markers);
  normal.coupling.setZero(jacobian.begins.back(), jacobian.num_globals);
  normal.globals.setZero(jacobian.num_globals, jacobian.num_globals);
  std::vector<std::vector<const ResidualJacobian*>> of_marker(num_markers);
  for (const auto* blocks : {&jacobian.corners, &jacobian.priors}) {
    for (const ResidualJacobian& block : *blocks) {
      if (block.marker_idx >= 0) {
        of_marker[static_cast<std::size_t>(block.marker_idx)].push_back(&block);
      }
      for (const auto& [column, by_column] : block.by_globals) {
        for (const auto& [row, by_row] : block.by_globals) {
          if (row < column) continue;
          normal.globals.block(row, column, by_row.cols(), by_column.cols()) +=
              by_row.transpose().lazyProduct(by_column);
        }
      }
    }
  }
  ParallelFor(num_markers, num_threads, [&](std::size_t idx) {
    const Eigen::Index begin = jacobian.begins[idx], size = jacobian.begins[idx + 1] - begin;
    Eigen::MatrixXd& hessian = normal.marker_blocks[idx];
    hessian.setZero(size, size);
    for (const ResidualJacobian* block : of_marker[idx]) {
      hessian += block->by_marker.transpose().lazyProduct(block->by_marker);
      for (const auto& [column, by_globals] : block->by_globals) {
        normal.coupling.block(begin, column, size, by_globals.cols()) +=
            block->by_marker.transpose().lazyProduct(by_globals);
      }
    }
  });
  return normal;
}

// The lower root of the matrix that the global parameters have once the markers are eliminated.
// Returns nothing if the markers leave one of them undetermined. Works in place: thousands of
// images make matrices of gigabytes.
std::optional<Eigen::MatrixXd> RootOfGlobals(Eigen::MatrixXd globals, const RowMajorMatrix& factor,
                                             int num_threads) {
  const Eigen::VectorXd information = globals.diagonal();
  ForEachPanel(globals.cols(), num_threads, [&](Eigen::Index begin, Eigen::Index width) {
    const Eigen::Index height = globals.rows() - begin;
    globals.block(begin, begin, height, width).noalias() -=
        factor.rightCols(height).transpose() * factor.middleCols(begin, width);
  });
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> decomposition(globals);
  if (decomposition.info() != Eigen::Success) return std::nullopt;
  // A global parameter is undetermined if the markers absorb all of it except for rounding errors.
  constexpr double kMinShareOfInformation = 1e-14;
  for (Eigen::Index i = 0; i < globals.rows(); ++i) {
    const double left = globals(i, i) * globals(i, i);
    if (!(left > kMinShareOfInformation * information[i])) return std::nullopt;
  }
  globals.triangularView<Eigen::StrictlyUpper>().setZero();
  return globals;
}

}  // namespace

MarkerJacobian EvaluateJacobian(const MarkerProblem& problem) {
  MarkerJacobian jacobian;
  std::vector<int> marker_of_column;
  for (const double* block : problem.marker_blocks) {
    jacobian.begins.push_back(static_cast<Eigen::Index>(marker_of_column.size()));
    const int marker_idx = static_cast<int>(jacobian.begins.size()) - 1;
    marker_of_column.insert(marker_of_column.end(),
                            static_cast<std::size_t>(problem.ceres->ParameterBlockSize(block)),
                            marker_idx);
  }
  jacobian.begins.push_back(static_cast<Eigen::Index>(marker_of_column.size()));

  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = problem.marker_blocks;
  options.parameter_blocks.insert(options.parameter_blocks.end(), problem.global_blocks.begin(),
                                  problem.global_blocks.end());
  options.residual_blocks = problem.ResidualsWithoutBars();
  ceres::CRSMatrix sparse;
  VELAMAP_CHECK(problem.ceres->Evaluate(options, nullptr, nullptr, nullptr, &sparse));
  jacobian.num_globals = sparse.num_cols - static_cast<int>(marker_of_column.size());

  std::size_t row = 0;
  for (const ceres::ResidualBlockId id : options.residual_blocks) {
    const int num_rows = problem.ceres->GetCostFunctionForResidualBlock(id)->num_residuals();
    const int begin = sparse.rows[row], width = sparse.rows[row + 1] - begin;
    const Eigen::Map<const RowMajorMatrix> derivatives(sparse.values.data() + begin, num_rows,
                                                       width);
    auto& blocks = jacobian.corners.size() < problem.corner_residuals.size() ? jacobian.corners
                                                                             : jacobian.priors;
    blocks.push_back(SplitColumns(derivatives, sparse.cols.data() + begin, marker_of_column));
    row += static_cast<std::size_t>(num_rows);
  }
  return jacobian;
}

std::optional<MarkerCovariance> InvertNormalEquations(const MarkerJacobian& jacobian,
                                                      int num_threads) {
  NormalMatrix normal = SumProducts(jacobian, num_threads);
  const std::size_t num_markers = normal.marker_blocks.size();
  MarkerCovariance covariance;
  covariance.begins = jacobian.begins;
  covariance.factor = std::move(normal.coupling);
  RowMajorMatrix& factor = covariance.factor;
  const auto rows_of = [&](std::size_t idx) {
    const Eigen::Index begin = covariance.begins[idx];
    return factor.middleRows(begin, covariance.begins[idx + 1] - begin);
  };
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots(num_markers);
  std::atomic<bool> is_definite{true};
  ParallelFor(num_markers, num_threads, [&](std::size_t idx) {
    roots[idx].compute(normal.marker_blocks[idx]);
    if (roots[idx].info() != Eigen::Success) {
      is_definite = false;
      return;
    }
    auto rows = rows_of(idx);
    roots[idx].matrixL().solveInPlace(rows);
  });
  if (!is_definite) return std::nullopt;

  auto root = RootOfGlobals(std::move(normal.globals), factor, num_threads);
  if (!root) return std::nullopt;
  covariance.root = *std::move(root);

  covariance.marker_blocks.resize(num_markers);
  ParallelFor(num_markers, num_threads, [&](std::size_t idx) {
    auto rows = rows_of(idx);
    covariance.marker_blocks[idx] =
        roots[idx].solve(Eigen::MatrixXd::Identity(rows.rows(), rows.rows()));
    roots[idx].matrixU().solveInPlace(rows);
  });
  ForEachPanel(factor.rows(), num_threads, [&](Eigen::Index begin, Eigen::Index height) {
    auto rows = factor.middleRows(begin, height);
    covariance.root.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(
        rows);
  });
  return covariance;
}

ParameterColumns ZeroColumns(const MarkerCovariance& covariance, Eigen::Index num_columns) {
  return {RowMajorMatrix::Zero(covariance.factor.rows(), num_columns),
          RowMajorMatrix::Zero(covariance.root.rows(), num_columns)};
}

void AddGradient(const ResidualJacobian& block, const MarkerCovariance& covariance,
                 const RowMajorMatrix& errors, Eigen::Index row, Eigen::Index column,
                 ParameterColumns* gradient) {
  const auto rows = errors.middleRows(row, block.NumRows());
  const auto add = [&](const RowMajorMatrix& derivatives, Eigen::Index begin,
                       RowMajorMatrix* sums) {
    sums->block(begin, column, derivatives.cols(), errors.cols()) +=
        derivatives.transpose().lazyProduct(rows);
  };
  if (block.marker_idx >= 0) {
    add(block.by_marker, covariance.begins[static_cast<std::size_t>(block.marker_idx)],
        &gradient->of_points);
  }
  for (const auto& [first, derivatives] : block.by_globals) {
    add(derivatives, first, &gradient->of_globals);
  }
}

void MultiplyByCovariance(const MarkerCovariance& covariance, ParameterColumns* columns) {
  auto& [points, globals] = *columns;
  const auto root = covariance.root.triangularView<Eigen::Lower>();
  root.solveInPlace(globals);
  globals.noalias() -= covariance.factor.transpose() * points;
  for (std::size_t i = 0; i < covariance.marker_blocks.size(); ++i) {
    const Eigen::MatrixXd& block = covariance.marker_blocks[i];
    auto rows = points.middleRows(covariance.begins[i], block.rows());
    rows = (block * rows).eval();
  }
  points.noalias() -= covariance.factor * globals;
  root.transpose().solveInPlace(globals);
}

ParameterColumns LeastSquaresStep(const MarkerJacobian& jacobian,
                                  const MarkerCovariance& covariance,
                                  const RowMajorMatrix& errors) {
  ParameterColumns step = ZeroColumns(covariance, errors.cols());
  Eigen::Index row = 0;
  for (const auto* blocks : {&jacobian.corners, &jacobian.priors}) {
    for (const ResidualJacobian& block : *blocks) {
      AddGradient(block, covariance, errors, row, 0, &step);
      row += block.NumRows();
    }
  }
  MultiplyByCovariance(covariance, &step);
  return step;
}

RowMajorMatrix ErrorsLeft(const MarkerJacobian& jacobian, const MarkerCovariance& covariance,
                          const RowMajorMatrix& errors) {
  const ParameterColumns step = LeastSquaresStep(jacobian, covariance, errors);
  RowMajorMatrix left = errors;
  Eigen::Index row = 0;
  for (const auto* blocks : {&jacobian.corners, &jacobian.priors}) {
    for (const ResidualJacobian& block : *blocks) {
      auto rows = left.middleRows(row, block.NumRows());
      if (block.marker_idx >= 0) {
        rows -= block.by_marker.lazyProduct(step.of_points.middleRows(
            covariance.begins[static_cast<std::size_t>(block.marker_idx)], block.by_marker.cols()));
      }
      for (const auto& [column, derivatives] : block.by_globals) {
        rows -= derivatives.lazyProduct(step.of_globals.middleRows(column, derivatives.cols()));
      }
      row += block.NumRows();
    }
  }
  return left;
}

double Leverage(const MarkerCovariance& covariance, const ResidualJacobian& jacobian) {
  const Eigen::Index num_globals = covariance.root.rows(), num_rows = jacobian.NumRows();
  Eigen::Index first = num_globals;
  for (const auto& [column, derivatives] : jacobian.by_globals) {
    first = std::min<Eigen::Index>(first, column);
  }
  // L^-1 by_globals^T, which is zero if by_globals begins with zeros.
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
