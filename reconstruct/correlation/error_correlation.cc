#include "reconstruct/correlation/error_correlation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <utility>

#include "importer/base/log.h"
#include "importer/base/natural_order.h"
#include "importer/base/parallel.h"
#include "reconstruct/geometry/covariance_update.h"
#include "reconstruct/problem/marker_uncertainty.h"

namespace velamap {
namespace {

// Simulated errors pass through the adjustment in batches, one draw a column, until their mean is
// known well enough.
constexpr int kBatchSize = 8, kMinNumBatches = 2, kMaxNumBatches = 5;
// The simulation ends when 1 sigma of the expected movement is below this fraction of it.
constexpr double kMaxMeanSigma = 0.005;

// What the steps of all parameters change: one row for each quantity, one column for each case.
using Movements = std::function<RowMajorMatrix(const ParameterColumns& steps)>;

// The linearized adjustment: maps errors of the residuals to movements. Errors and residuals have
// one row for each residual (corners, then priors) and one column for each case.
class LinearAdjustment {
 public:
  LinearAdjustment(const MarkerState& state, const MarkerProblem& problem,
                   const MarkerJacobian& jacobian, const MarkerCovariance& covariance,
                   const std::vector<int>& groups, Movements movements)
      : jacobian_(jacobian), covariance_(covariance), movements_(std::move(movements)) {
    num_groups_ = 1 + *std::max_element(groups.begin(), groups.end());
    std::map<ImageId, int> group_of_image;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      group_of_image[state.images[i].image_id] = groups[i];
    }
    for (const ResidualJacobian& block : jacobian.corners) {
      const auto first_corner = static_cast<std::size_t>(num_rows_ / 2);
      group_of_block_.push_back(group_of_image.at(problem.corners[first_corner].second.image_id));
      num_rows_ += block.NumRows();
    }
    for (const ResidualJacobian& block : jacobian.priors) num_rows_ += block.NumRows();
  }

  Eigen::Index NumRows() const { return num_rows_; }

  // Squared movement that the corners' residuals of one group alone cause, summed over the groups,
  // for each case.
  Eigen::VectorXd SquaredMovements(const RowMajorMatrix& residuals) const {
    const Eigen::Index num_cases = residuals.cols();
    ParameterColumns parameters = ZeroColumns(covariance_, num_groups_ * num_cases);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < jacobian_.corners.size(); ++i) {
      AddGradient(jacobian_.corners[i], covariance_, residuals, row, group_of_block_[i] * num_cases,
                  &parameters);
      row += jacobian_.corners[i].NumRows();
    }
    MultiplyByCovariance(covariance_, &parameters);
    const Eigen::VectorXd squares = movements_(parameters).colwise().squaredNorm().transpose();
    return Eigen::Map<const Eigen::MatrixXd>(squares.data(), num_cases, num_groups_)
        .rowwise()
        .sum();
  }

  // Residuals that the adjustment leaves of such errors.
  RowMajorMatrix Residuals(const RowMajorMatrix& errors) const {
    return ErrorsLeft(jacobian_, covariance_, errors);
  }

 private:
  const MarkerJacobian& jacobian_;
  const MarkerCovariance& covariance_;
  Movements movements_;
  Eigen::Index num_rows_ = 0;
  std::vector<int> group_of_block_;
  int num_groups_ = 0;
};

// Mean and standard deviation of the squared movement that independent errors cause.
struct ExpectedMovement {
  double mean = 0.0;
  double sigma = 0.0;
  double mean_sigma = 0.0;  // of the root of the mean, as a fraction
};

ExpectedMovement SimulateIndependentErrors(const LinearAdjustment& adjustment, int num_threads) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::array<Eigen::VectorXd, kMaxNumBatches> movements;
  // Two batches at a time on two threads; a second one that is not needed is not counted.
  const auto simulate = [&](int first_batch) {
    const int count = std::min(2, kMaxNumBatches - first_batch);
    std::array<RowMajorMatrix, 2> errors;
    for (int i = 0; i < count; ++i) {
      errors[i].resize(adjustment.NumRows(), kBatchSize);
      for (auto column : errors[i].colwise()) {
        for (double& error : column) error = normal(random);
      }
    }
    ParallelFor(count, num_threads, [&](std::size_t i) {
      movements[first_batch + i] = adjustment.SquaredMovements(adjustment.Residuals(errors[i]));
    });
  };
  ExpectedMovement expected;
  double sum = 0.0, sum_of_squares = 0.0;
  for (int batch = 0; batch < kMaxNumBatches; ++batch) {
    if (batch % 2 == 0) simulate(batch);
    sum += movements[batch].sum();
    sum_of_squares += movements[batch].squaredNorm();
    const double num_draws = (batch + 1) * kBatchSize;
    expected.mean = sum / num_draws;
    expected.sigma =
        std::sqrt(std::max(0.0, sum_of_squares / num_draws - expected.mean * expected.mean));
    expected.mean_sigma = 0.5 * expected.sigma / (expected.mean * std::sqrt(num_draws));
    if (batch + 1 >= kMinNumBatches && expected.mean_sigma <= kMaxMeanSigma) break;
  }
  return expected;
}

// How much farther than independent errors the residuals of the groups move the result.
struct Excess {
  double factor = 1.0;
  double factor_sigma = 0.0;  // of independent errors
  bool is_significant = false;

  double SignificantFactor() const { return is_significant ? factor : 1.0; }
};

Excess FindExcess(const LinearAdjustment& adjustment, const MarkerProblem& problem,
                  int num_threads) {
  RowMajorMatrix residuals = RowMajorMatrix::Zero(adjustment.NumRows(), 1);
  const std::vector<double> of_corners = CornerResiduals(problem);
  std::copy(of_corners.begin(), of_corners.end(), residuals.data());
  const double found = adjustment.SquaredMovements(residuals)[0];
  const ExpectedMovement expected = SimulateIndependentErrors(adjustment, num_threads);
  return {std::sqrt(found / expected.mean), 0.5 * expected.sigma / expected.mean,
          found > expected.mean + 2.0 * expected.sigma};
}

}  // namespace

std::vector<int> GroupImages(const Model& model, int max_num_groups) {
  const std::size_t count = model.images.size();
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&model](std::size_t a, std::size_t b) {
    return NaturalLess(model.images[a].name, model.images[b].name);
  });
  const std::size_t num_groups = std::min(count, static_cast<std::size_t>(max_num_groups));
  std::vector<int> groups(count);
  for (std::size_t i = 0; i < count; ++i)
    groups[order[i]] = static_cast<int>(i * num_groups / count);
  return groups;
}

double CorrelationFactor(const MarkerState& state, const MarkerProblem& problem,
                         const MarkerJacobian& jacobian, const MarkerCovariance& covariance,
                         const std::vector<int>& groups, int num_threads) {
  const std::vector<Eigen::Vector3d> positions = Positions(state);
  Eigen::MatrixXd motions = RigidMotions(positions);  // orthonormal, with that of the scale
  motions.conservativeResize(Eigen::NoChange, motions.cols() + 1);
  motions.rightCols<1>() = ScaleGradient(positions).normalized();
  const auto of_shape = [&](const ParameterColumns& steps) -> RowMajorMatrix {
    return steps.of_points - motions * (motions.transpose() * steps.of_points);
  };
  const Excess excess =
      FindExcess(LinearAdjustment(state, problem, jacobian, covariance, groups, of_shape), problem,
                 num_threads);
  LogDebug(
      "the residuals of groups of images move the shape {:.3f} +- {:.3f} times as far as "
      "independent errors",
      excess.factor, excess.factor_sigma);
  return excess.SignificantFactor();
}

double CorrelationFactorOf(const Eigen::SparseMatrix<double>& by_points, const MarkerState& state,
                           const MarkerProblem& problem, const MarkerJacobian& jacobian,
                           const MarkerCovariance& covariance, const std::vector<int>& groups,
                           int num_threads) {
  const auto of_functions = [&](const ParameterColumns& steps) -> RowMajorMatrix {
    return by_points * steps.of_points;
  };
  return FindExcess(LinearAdjustment(state, problem, jacobian, covariance, groups, of_functions),
                    problem, num_threads)
      .SignificantFactor();
}

double GlobalCorrelationFactor(const MarkerState& state, const MarkerProblem& problem,
                               const MarkerJacobian& jacobian, const MarkerCovariance& covariance,
                               const std::vector<int>& groups, int column, int num_threads) {
  const auto of_global = [column](const ParameterColumns& steps) -> RowMajorMatrix {
    return steps.of_globals.row(column);
  };
  const Excess excess =
      FindExcess(LinearAdjustment(state, problem, jacobian, covariance, groups, of_global), problem,
                 num_threads);
  return std::max(1.0, excess.factor);
}

double SigmaByImageErrors(const MarkerProblem& problem, const MarkerJacobian& jacobian,
                          const MarkerCovariance& covariance, int column,
                          const RowMajorMatrix& errors) {
  ParameterColumns by_gradient = ZeroColumns(covariance, 1);
  by_gradient.of_globals(column, 0) = 1.0;
  MultiplyByCovariance(covariance, &by_gradient);
  std::map<ImageId, Eigen::VectorXd> movements;
  Eigen::Index row = 0;
  for (const ResidualJacobian& block : jacobian.corners) {
    const auto marker = static_cast<std::size_t>(block.marker_idx);
    Eigen::VectorXd by_residual =
        block.by_marker *
        by_gradient.of_points.middleRows(covariance.begins[marker], block.by_marker.cols());
    for (const auto& [first, derivatives] : block.by_globals) {
      by_residual += derivatives * by_gradient.of_globals.middleRows(first, derivatives.cols());
    }
    const ImageId image_id = problem.corners[static_cast<std::size_t>(row / 2)].second.image_id;
    const auto movement =
        movements.try_emplace(image_id, Eigen::VectorXd::Zero(errors.cols())).first;
    movement->second += errors.middleRows(row, block.NumRows()).transpose() * by_residual;
    row += block.NumRows();
  }
  double variance = 0.0;
  for (const auto& [image_id, movement] : movements) variance += movement.squaredNorm();
  return std::sqrt(variance);
}

}  // namespace velamap
