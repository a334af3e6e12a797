#include "reconstruct/error_correlation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <spdlog/spdlog.h>

#include "importer/error.h"
#include "reconstruct/covariance_update.h"
#include "reconstruct/marker_uncertainty.h"

namespace velamap {
namespace {

// Few, so that errors that last for a tenth of a video still fall into one group.
constexpr std::size_t kMaxNumGroups = 5;
constexpr int kNumDraws = 40;

// The linearised adjustment: from errors of the residuals to movements of the points.
class LinearAdjustment {
 public:
  LinearAdjustment(const MarkerState& state, const MarkerProblem& problem,
                   const MarkerCovariance& covariance, const std::vector<int>& groups)
      : covariance_(covariance), rows_(JacobianRows(problem, problem.corner_residuals)) {
    num_corner_rows_ = rows_.size();
    for (JacobianRow& row : JacobianRows(problem, problem.prior_residuals)) {
      rows_.push_back(std::move(row));
    }
    for (const MarkerBlock& marker : state.markers) {
      begins_.push_back(num_coordinates_);
      num_coordinates_ += static_cast<Eigen::Index>(marker.x_in_world.size());
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
    for (const auto& [point3D_id, element] : problem.corners) {
      group_of_row_.insert(group_of_row_.end(), 2, group_of_image.at(element.image_id));
    }
  }

  std::size_t NumRows() const { return rows_.size(); }

  // Sum over the groups of the squared movement that the corners' residuals of the group alone
  // make. Takes errors of corners and priors.
  double OfResiduals(const Eigen::VectorXd& residuals) const {
    double sum = 0.0;
    for (int group = 0; group < num_groups_; ++group) {
      sum += InShape(Step(Gradient(residuals, group)).of_points).squaredNorm();
    }
    return sum;
  }

  // What the adjustment leaves of such errors.
  Eigen::VectorXd Residuals(const Eigen::VectorXd& errors) const {
    const Parameters step = Step(Gradient(errors, -1));
    Eigen::VectorXd residuals = errors;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const JacobianRow& row = rows_[i];
      double& residual = residuals[static_cast<Eigen::Index>(i)];
      if (row.marker_idx >= 0) {
        residual -= row.by_marker.dot(
            step.of_points.segment(begins_[row.marker_idx], row.by_marker.size()));
      }
      for (const auto& [column, value] : row.by_globals)
        residual -= value * step.of_globals[column];
    }
    return residuals;
  }

 private:
  struct Parameters {
    Eigen::VectorXd of_points, of_globals;
  };

  // J^T residuals, of the corners of one group, or of all rows (-1).
  Parameters Gradient(const Eigen::VectorXd& residuals, int group) const {
    Parameters gradient{Eigen::VectorXd::Zero(num_coordinates_),
                        Eigen::VectorXd::Zero(covariance_.root.rows())};
    const std::size_t end = group < 0 ? rows_.size() : num_corner_rows_;
    for (std::size_t i = 0; i < end; ++i) {
      if (group >= 0 && group_of_row_[i] != group) continue;
      const JacobianRow& row = rows_[i];
      const double residual = residuals[static_cast<Eigen::Index>(i)];
      if (row.marker_idx >= 0) {
        gradient.of_points.segment(begins_[row.marker_idx], row.by_marker.size()) +=
            residual * row.by_marker;
      }
      for (const auto& [column, value] : row.by_globals) {
        gradient.of_globals[column] += residual * value;
      }
    }
    return gradient;
  }

  // Covariance times gradient: normal_equations.h.
  Parameters Step(const Parameters& gradient) const {
    Eigen::VectorXd globals = gradient.of_globals;
    covariance_.root.triangularView<Eigen::Lower>().solveInPlace(globals);
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      const Eigen::MatrixXd& factor = covariance_.factors[i];
      globals -= factor.transpose() * gradient.of_points.segment(begins_[i], factor.rows());
    }
    Parameters step{Eigen::VectorXd(num_coordinates_), {}};
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      const Eigen::MatrixXd& factor = covariance_.factors[i];
      step.of_points.segment(begins_[i], factor.rows()) =
          covariance_.marker_blocks[i] * gradient.of_points.segment(begins_[i], factor.rows()) -
          factor * globals;
    }
    covariance_.root.triangularView<Eigen::Lower>().transpose().solveInPlace(globals);
    step.of_globals = std::move(globals);
    return step;
  }

  Eigen::VectorXd InShape(const Eigen::VectorXd& movement) const {
    return movement - motions_ * (motions_.transpose() * movement);
  }

  const MarkerCovariance& covariance_;
  std::vector<JacobianRow> rows_;  // corners, then priors
  std::size_t num_corner_rows_ = 0;
  std::vector<int> group_of_row_;
  int num_groups_ = 0;
  std::vector<Eigen::Index> begins_;  // first coordinate, by marker
  Eigen::Index num_coordinates_ = 0;
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
  std::vector<double> residuals;
  const auto append = [&residuals](const SchurResidual&, const Eigen::VectorXd& of_block,
                                   const std::vector<SchurSystem::RowMajor>&) {
    residuals.insert(residuals.end(), of_block.begin(), of_block.end());
  };
  VELAMAP_CHECK(VisitResiduals(problem.schur, problem.corner_residuals, false, append));
  residuals.resize(adjustment.NumRows(), 0.0);
  const double found =
      adjustment.OfResiduals(Eigen::Map<const Eigen::VectorXd>(residuals.data(), residuals.size()));

  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd errors(static_cast<Eigen::Index>(adjustment.NumRows()));
  double sum = 0.0, sum_of_squares = 0.0;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    for (double& error : errors) error = normal(random);
    const double value = adjustment.OfResiduals(adjustment.Residuals(errors));
    sum += value;
    sum_of_squares += value * value;
  }
  const double mean = sum / kNumDraws;
  const double sigma = std::sqrt(std::max(0.0, sum_of_squares / kNumDraws - mean * mean));
  spdlog::debug("groups of images move the shape by {:.3f} times (+- {:.3f}) what chance does",
                std::sqrt(found / mean), 0.5 * sigma / mean);
  return found > mean + 2.0 * sigma ? std::sqrt(found / mean) : 1.0;
}

}  // namespace velamap
