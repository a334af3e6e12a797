#include "reconstruct/adjust/error_correlation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <spdlog/spdlog.h>

#include "importer/base/error.h"
#include "reconstruct/adjust/marker_uncertainty.h"
#include "reconstruct/geometry/covariance_update.h"
#include "reconstruct/solve/double_lanes.h"

namespace velamap {
namespace {

// Few, so that errors that last for a tenth of a video still fall into one group.
constexpr std::size_t kMaxNumGroups = 5;
// Draws go through the adjustment so many at a time, as columns, until their mean is known.
constexpr int kNumDrawsAtOnce = 8;
constexpr int kMinNumDraws = 16, kMaxNumDraws = 40;
// 1 sigma of what chance moves the shape by, as a fraction.
constexpr double kEnough = 0.005;

// One case a column.
template <int kNumCases>
using Cases = Eigen::Matrix<double, Eigen::Dynamic, kNumCases,
                            kNumCases == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

// The linearised adjustment: from errors of the residuals to movements of the points.
class LinearAdjustment {
 public:
  LinearAdjustment(const MarkerState& state, const MarkerProblem& problem,
                   const MarkerCovariance& covariance, const std::vector<int>& groups)
      : covariance_(covariance), blocks_(ResidualJacobians(problem, problem.corner_residuals)) {
    num_corner_blocks_ = blocks_.size();
    for (ResidualJacobian& prior : ResidualJacobians(problem, problem.prior_residuals)) {
      blocks_.push_back(std::move(prior));
    }
    for (const ResidualJacobian& block : blocks_) {
      begins_.push_back(num_rows_);
      num_rows_ += NumRows(block);
    }
    const std::vector<Eigen::Vector3d> positions = Positions(state);
    motions_ = RigidMotions(positions);
    motions_.conservativeResize(Eigen::NoChange, motions_.cols() + 1);
    motions_.rightCols<1>() = ScaleGradient(positions).normalized();
    num_groups_ = 1 + *std::max_element(groups.begin(), groups.end());
    std::map<ImageId, int> group_of_image;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      group_of_image[state.images[i].image_id] = groups[i];
    }
    for (std::size_t i = 0, row = 0; i < num_corner_blocks_; ++i) {
      group_of_block_.push_back(group_of_image.at(problem.corners[row / 2].second.image_id));
      row += static_cast<std::size_t>(NumRows(blocks_[i]));
    }
  }

  Eigen::Index NumRows() const { return num_rows_; }

  // Sum over the groups of the squared movement that the corners' residuals of the group alone
  // make, by case. Takes errors of corners and priors.
  template <int kNumCases>
  Eigen::Matrix<double, kNumCases, 1> OfResiduals(const Cases<kNumCases>& residuals) const {
    Parameters parameters = Zero(num_groups_ * kNumCases);
    for (std::size_t i = 0; i < num_corner_blocks_; ++i) {
      AddGradient<kNumCases>(i, residuals, group_of_block_[i] * kNumCases, &parameters);
    }
    Solve(&parameters);
    RowMajorMatrix& movements = parameters.of_points;
    movements -= motions_ * (motions_.transpose() * movements).eval();
    const Eigen::VectorXd squares = movements.colwise().squaredNorm().transpose();
    return Eigen::Map<const Eigen::Matrix<double, kNumCases, Eigen::Dynamic>>(
               squares.data(), kNumCases, num_groups_)
        .rowwise()
        .sum();
  }

  // What the adjustment leaves of such errors.
  template <int kNumCases>
  Cases<kNumCases> Residuals(const Cases<kNumCases>& errors) const {
    Parameters step = Zero(kNumCases);
    for (std::size_t i = 0; i < blocks_.size(); ++i) AddGradient<kNumCases>(i, errors, 0, &step);
    Solve(&step);
    Cases<kNumCases> residuals = errors;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      double* out = residuals.data() + begins_[i] * kNumCases;
      const auto subtract = [out](const RowMajorMatrix& derivatives, const RowMajorMatrix& values,
                                  Eigen::Index begin) {
        AddProduct<kNumCases, -1>(derivatives, values.data() + begin * kNumCases, kNumCases, out,
                                  kNumCases);
      };
      const ResidualJacobian& block = blocks_[i];
      if (block.marker_idx >= 0) {
        subtract(block.by_marker, step.of_points, covariance_.begins[block.marker_idx]);
      }
      for (const auto& [column, derivatives] : block.by_globals) {
        subtract(derivatives, step.of_globals, column);
      }
    }
    return residuals;
  }

 private:
  struct Parameters {
    RowMajorMatrix of_points, of_globals;
  };

  static Eigen::Index NumRows(const ResidualJacobian& block) {
    return block.marker_idx >= 0 ? block.by_marker.rows() : block.by_globals.front().second.rows();
  }

  Parameters Zero(Eigen::Index num_columns) const {
    return {RowMajorMatrix::Zero(covariance_.factor.rows(), num_columns),
            RowMajorMatrix::Zero(covariance_.root.rows(), num_columns)};
  }

  // Adds J^T residuals of one block to the columns from `column` on.
  template <int kNumCases>
  void AddGradient(std::size_t block_idx, const Cases<kNumCases>& residuals, Eigen::Index column,
                   Parameters* gradient) const {
    const double* of_block = residuals.data() + begins_[block_idx] * kNumCases;
    const auto add = [&](const RowMajorMatrix& derivatives, Eigen::Index begin,
                         RowMajorMatrix* sums) {
      AddTransposedProduct<kNumCases>(derivatives, of_block, kNumCases,
                                      sums->data() + begin * sums->cols() + column, sums->cols());
    };
    const ResidualJacobian& block = blocks_[block_idx];
    if (block.marker_idx >= 0) {
      add(block.by_marker, covariance_.begins[block.marker_idx], &gradient->of_points);
    }
    for (const auto& [first, derivatives] : block.by_globals) {
      add(derivatives, first, &gradient->of_globals);
    }
  }

  // From a gradient to the covariance times it: normal_equations.h.
  void Solve(Parameters* parameters) const {
    auto& [points, globals] = *parameters;
    const auto root = covariance_.root.triangularView<Eigen::Lower>();
    root.solveInPlace(globals);
    globals.noalias() -= covariance_.factor.transpose() * points;
    for (std::size_t i = 0; i < covariance_.marker_blocks.size(); ++i) {
      const Eigen::MatrixXd& block = covariance_.marker_blocks[i];
      auto rows = points.middleRows(covariance_.begins[i], block.rows());
      rows = (block * rows).eval();
    }
    points.noalias() -= covariance_.factor * globals;
    root.transpose().solveInPlace(globals);
  }

  const MarkerCovariance& covariance_;
  std::vector<ResidualJacobian> blocks_;  // corners, then priors
  std::size_t num_corner_blocks_ = 0;
  std::vector<Eigen::Index> begins_;  // first row, by block
  Eigen::Index num_rows_ = 0;
  std::vector<int> group_of_block_;
  int num_groups_ = 0;
  Eigen::MatrixXd motions_;  // orthonormal: rigid, and of scale
};

}  // namespace

std::vector<int> GroupImages(const Model& model, const MarkerState& state) {
  const std::size_t count = state.images.size();
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&model](std::size_t a, std::size_t b) {
    return model.images[a].name < model.images[b].name;
  });
  const std::size_t num_groups = std::min(count, kMaxNumGroups);
  std::vector<int> groups(count);
  for (std::size_t i = 0; i < count; ++i)
    groups[order[i]] = static_cast<int>(i * num_groups / count);
  return groups;
}

double CorrelationFactor(const MarkerState& state, const MarkerProblem& problem,
                         const MarkerCovariance& covariance, const std::vector<int>& groups) {
  const LinearAdjustment adjustment(state, problem, covariance, groups);
  Cases<1> residuals = Cases<1>::Zero(adjustment.NumRows());
  Eigen::Index row = 0;
  const auto append = [&](const SchurResidual&, const Eigen::VectorXd& of_block,
                          const std::vector<SchurSystem::RowMajor>&) {
    residuals.segment(row, of_block.size()) = of_block;
    row += of_block.size();
  };
  VELAMAP_CHECK(VisitResiduals(problem.schur, problem.corner_residuals, false, append));
  const double found = adjustment.OfResiduals<1>(residuals)[0];

  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Cases<kNumDrawsAtOnce> errors(adjustment.NumRows(), kNumDrawsAtOnce);
  double sum = 0.0, sum_of_squares = 0.0, mean = 0.0, sigma = 0.0;
  for (int num_draws = kNumDrawsAtOnce; num_draws <= kMaxNumDraws; num_draws += kNumDrawsAtOnce) {
    for (int draw = 0; draw < kNumDrawsAtOnce; ++draw) {
      for (double& error : errors.col(draw)) error = normal(random);
    }
    const auto values =
        adjustment.OfResiduals<kNumDrawsAtOnce>(adjustment.Residuals<kNumDrawsAtOnce>(errors));
    sum += values.sum();
    sum_of_squares += values.squaredNorm();
    mean = sum / num_draws;
    sigma = std::sqrt(std::max(0.0, sum_of_squares / num_draws - mean * mean));
    if (num_draws >= kMinNumDraws && 0.5 * sigma <= kEnough * mean * std::sqrt(num_draws)) break;
  }
  spdlog::debug("groups of images move the shape by {:.3f} times (+- {:.3f}) what chance does",
                std::sqrt(found / mean), 0.5 * sigma / mean);
  return found > mean + 2.0 * sigma ? std::sqrt(found / mean) : 1.0;
}

}  // namespace velamap
