// A SchurProblem as a Ceres problem, to compare with what Ceres makes of it.

#pragma once

#include <memory>
#include <vector>

#include <ceres/problem.h>

#include "reconstruct/solve/schur_problem.h"

namespace velamap {

// Works on the same values; owns nothing.
inline std::unique_ptr<ceres::Problem> MakeCeresProblem(const SchurProblem& schur) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  auto problem = std::make_unique<ceres::Problem>(options);
  for (const SchurBlock& block : schur.blocks) {
    problem->AddParameterBlock(block.values, block.size,
                               const_cast<ceres::Manifold*>(block.manifold));
    if (block.kind == SchurBlock::Kind::kConstant) problem->SetParameterBlockConstant(block.values);
  }
  for (const SchurResidual& residual : schur.residuals) {
    std::vector<double*> values;
    for (const int block_idx : residual.block_idxs) {
      values.push_back(schur.blocks[static_cast<std::size_t>(block_idx)].values);
    }
    problem->AddResidualBlock(const_cast<ceres::CostFunction*>(residual.error),
                              const_cast<ceres::LossFunction*>(residual.loss), values);
  }
  return problem;
}

// Those that vary, in order.
inline std::vector<double*> VaryingBlocks(const SchurProblem& schur) {
  std::vector<double*> blocks;
  for (const SchurBlock& block : schur.blocks) {
    if (block.kind != SchurBlock::Kind::kConstant) blocks.push_back(block.values);
  }
  return blocks;
}

}  // namespace velamap
