// A least-squares problem with two kinds of parameter blocks, as a bundle adjustment has them, and
// its normal equations. Private to this room: it shows Ceres, whose cost functions, losses and
// manifolds it takes.
//
// Eliminated blocks (points, markers) share no residual with one another; kept ones (cameras, what
// all have in common) may. With the gradient (g, h) the normal equations of a step are
//
//   | D  W | (x)     (g)    D block-diagonal by eliminated block, W with the columns of those kept
//   | W' B | (y) = - (h),   blocks only that share a residual with it.
//
// Ceres has the same elimination, but compiled for 2 x 3 and the like: for a marker's twelve
// coordinates it runs through its general code, several times slower (README.md, "Speed").

#pragma once

#include <functional>
#include <vector>

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <Eigen/Core>

namespace velamap {

struct SchurBlock {
  enum class Kind { kEliminated, kKept, kConstant };
  double* values = nullptr;
  int size = 0;
  Kind kind = Kind::kConstant;
  const ceres::Manifold* manifold = nullptr;  // null: Euclidean

  int TangentSize() const { return manifold == nullptr ? size : manifold->TangentSize(); }
};

// A loss must not be convex anywhere (second derivative 0 at most), as Cauchy's.
struct SchurResidual {
  const ceres::CostFunction* error = nullptr;
  const ceres::LossFunction* loss = nullptr;  // null: none
  std::vector<int> block_idxs;                // in order of the cost function's parameters
};

// Owns nothing but the lists.
struct SchurProblem {
  std::vector<SchurBlock> blocks;
  std::vector<SchurResidual> residuals;
};

// Keeps those eliminated blocks that share a residual with another one.
void KeepCoupledBlocks(SchurProblem* problem);

// Where things are; stays the same from step to step.
struct SchurStructure {
  struct Eliminated {
    int block_idx = 0;
    std::vector<int> residual_idxs;
    std::vector<int> kept_block_idxs;  // ascending
    int num_columns = 0;               // of W
  };
  std::vector<Eliminated> eliminated;
  std::vector<int> residuals_of_kept;  // residuals without an eliminated block
  std::vector<int> kept_block_idxs;    // ascending
  std::vector<int> column_of_block;    // of kept blocks, in B; -1 for others
  int num_kept_columns = 0;
};

// Throws std::logic_error where a residual has two eliminated blocks.
SchurStructure MakeSchurStructure(const SchurProblem& problem);

struct SchurSystem {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Eliminated {
    RowMajor hessian;  // D
    Eigen::VectorXd gradient;
    RowMajor coupling;  // W, columns of its kept blocks one after another
  };
  double cost = 0.0;  // half the sum of squares, after the losses
  std::vector<Eliminated> eliminated;
  RowMajor kept_hessian;  // B, both triangles
  Eigen::VectorXd kept_gradient;
};

// False where a residual cannot be evaluated.
bool Linearise(const SchurProblem& problem, const SchurStructure& structure, SchurSystem* system);

// Half the sum of squares; infinite where a residual cannot be evaluated.
double EvaluateCost(const SchurProblem& problem);

// Calls `visit` with the residuals of one residual block after another, and with their derivatives
// by its blocks, in tangent spaces: meaningless for constant blocks, and all without
// `with_jacobians`. False where one cannot be evaluated.
using ResidualVisitor =
    std::function<void(const SchurResidual& residual, const Eigen::VectorXd& residuals,
                       const std::vector<SchurSystem::RowMajor>& jacobians)>;
bool VisitResiduals(const SchurProblem& problem, const std::vector<int>& residual_idxs,
                    bool with_jacobians, const ResidualVisitor& visit);

}  // namespace velamap
