// The damped normal equations of a SchurProblem, solved by elimination. Private to this room.

#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "reconstruct/solve/schur_problem.h"

namespace velamap {

// One value for every tangent of the eliminated blocks, block by block, and of the kept ones.
struct TangentVector {
  std::vector<Eigen::VectorXd> eliminated;
  Eigen::VectorXd kept;
};

// Eliminated blocks that share most of their kept ones go together: a product of large matrices is
// several times as fast as many of small ones.
class Eliminator {
 public:
  // Both must outlive it.
  Eliminator(const SchurProblem& problem, const SchurStructure& structure);

  // False where the equations have no solution.
  bool ComputeStep(const SchurSystem& system, const TangentVector& damping, TangentVector* step);

 private:
  struct Batch {
    std::size_t begin = 0, end = 0;  // of the eliminated blocks
    std::vector<int> kept_block_idxs;
    std::vector<Eigen::Index> row_begins, column_begins;  // with the end
    // With D = L L^T by block: L^-1 W and L^-1 g.
    SchurSystem::RowMajor coupling;
    Eigen::VectorXd gradient;
  };

  void MakeBatches();
  bool Reduce(const SchurSystem& system, const TangentVector& damping, Batch* batch);
  // S -= W^T D^-1 W and h -= W^T D^-1 g.
  void Subtract(const Batch& batch, Eigen::VectorXd* right);
  // x = -D^-1 (g + W y)
  void Substitute(const Batch& batch, TangentVector* step) const;
  Eigen::Index NumColumns(const std::vector<int>& block_idxs) const;
  int TangentSize(int block_idx) const;
  int Column(int block_idx) const;

  const SchurProblem& problem_;
  const SchurStructure& structure_;
  std::vector<Batch> batches_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots_;
  Eigen::MatrixXd schur_, update_;
  Eigen::LLT<Eigen::MatrixXd> root_;
};

}  // namespace velamap
