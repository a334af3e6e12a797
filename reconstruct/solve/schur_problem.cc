#include "reconstruct/solve/schur_problem.h"

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

#include "importer/base/error.h"
#include "reconstruct/solve/double_lanes.h"

namespace velamap {
namespace {

using RowMajor = SchurSystem::RowMajor;
using Kind = SchurBlock::Kind;

// out += a^T b for row-major a, b with as many rows; the usual widths of b are known to the
// compiler.
void AddGramProduct(const RowMajor& a, const RowMajor& b, double* out, Eigen::Index out_stride) {
  switch (b.cols()) {
    case 1:
      return AddTransposedProduct<1>(a, b.data(), 1, out, out_stride);
    case 6:
      return AddTransposedProduct<6>(a, b.data(), 6, out, out_stride);
    case 7:
      return AddTransposedProduct<7>(a, b.data(), 7, out, out_stride);
    case 12:
      return AddTransposedProduct<12>(a, b.data(), 12, out, out_stride);
    default:
      Eigen::Map<RowMajor, 0, Eigen::OuterStride<>>(out, a.cols(), b.cols(),
                                                    Eigen::OuterStride<>(out_stride)) +=
          a.transpose().lazyProduct(b);
  }
}

// *jacobian = full * plus_jacobian
void ToTangentSpace(const RowMajor& full, const RowMajor& plus_jacobian, RowMajor* jacobian) {
  const Eigen::Index size = plus_jacobian.cols();
  jacobian->setZero(full.rows(), size);
  if (size == 6) {
    AddProduct<6>(full, plus_jacobian.data(), size, jacobian->data(), size);
  } else if (size == 7) {
    AddProduct<7>(full, plus_jacobian.data(), size, jacobian->data(), size);
  } else {
    jacobian->noalias() = full.lazyProduct(plus_jacobian);
  }
}

// Evaluates residual blocks, in tangent spaces and with the losses' weights, one after another.
class Evaluator {
 public:
  explicit Evaluator(const SchurProblem& problem) : problem_(problem) {}

  // The derivatives of all manifolds, at the present values.
  void UpdateManifolds() {
    plus_jacobians_.resize(problem_.blocks.size());
    for (std::size_t i = 0; i < problem_.blocks.size(); ++i) {
      const SchurBlock& block = problem_.blocks[i];
      if (block.kind == Kind::kConstant || block.manifold == nullptr) continue;
      plus_jacobians_[i].resize(block.size, block.TangentSize());
      VELAMAP_CHECK(block.manifold->PlusJacobian(block.values, plus_jacobians_[i].data()));
    }
  }

  bool Evaluate(const SchurResidual& residual, bool with_jacobians) {
    const std::size_t num_blocks = residual.block_idxs.size();
    const int num_rows = residual.error->num_residuals();
    residuals_.resize(num_rows);
    values_.resize(num_blocks);
    jacobian_pointers_.assign(num_blocks, nullptr);
    if (full_.size() < num_blocks) full_.resize(num_blocks);
    if (jacobians_.size() < num_blocks) jacobians_.resize(num_blocks);
    for (std::size_t i = 0; i < num_blocks; ++i) {
      const SchurBlock& block = BlockOf(residual, i);
      values_[i] = block.values;
      if (!with_jacobians || block.kind == Kind::kConstant) continue;
      RowMajor& target = block.manifold == nullptr ? jacobians_[i] : full_[i];
      target.resize(num_rows, block.size);
      jacobian_pointers_[i] = target.data();
    }
    if (!residual.error->Evaluate(values_.data(), residuals_.data(),
                                  with_jacobians ? jacobian_pointers_.data() : nullptr)) {
      return false;
    }
    const double squared_norm = residuals_.squaredNorm();
    double rho[3] = {squared_norm, 1.0, 0.0};
    if (residual.loss != nullptr) residual.loss->Evaluate(squared_norm, rho);
    cost_ = 0.5 * rho[0];
    if (!with_jacobians) return true;
    const double weight = std::sqrt(rho[1]);
    if (residual.loss != nullptr) residuals_ *= weight;
    for (std::size_t i = 0; i < num_blocks; ++i) {
      if (jacobian_pointers_[i] == nullptr) continue;
      if (BlockOf(residual, i).manifold != nullptr) {
        ToTangentSpace(full_[i], plus_jacobians_[static_cast<std::size_t>(residual.block_idxs[i])],
                       &jacobians_[i]);
      }
      if (residual.loss != nullptr) jacobians_[i] *= weight;
    }
    return true;
  }

  double Cost() const { return cost_; }
  const Eigen::VectorXd& Residuals() const { return residuals_; }
  const RowMajor& Jacobian(std::size_t i) const { return jacobians_[i]; }
  const std::vector<RowMajor>& Jacobians() const { return jacobians_; }
  const SchurBlock& BlockOf(const SchurResidual& residual, std::size_t i) const {
    return problem_.blocks[static_cast<std::size_t>(residual.block_idxs[i])];
  }

 private:
  const SchurProblem& problem_;
  std::vector<RowMajor> plus_jacobians_;  // by block
  std::vector<RowMajor> full_, jacobians_;
  std::vector<const double*> values_;
  std::vector<double*> jacobian_pointers_;
  Eigen::VectorXd residuals_;
  double cost_ = 0.0;
};

// Adds the residual just evaluated to B and its gradient, and to those of its eliminated block.
// `columns` says where W has the kept blocks.
void AddResidual(const SchurResidual& residual, const Evaluator& evaluator,
                 const SchurStructure& structure, const std::vector<int>& columns,
                 SchurSystem::Eliminated* eliminated, SchurSystem* system) {
  for (std::size_t i = 0; i < residual.block_idxs.size(); ++i) {
    const SchurBlock& block = evaluator.BlockOf(residual, i);
    if (block.kind == Kind::kConstant) continue;
    const RowMajor& jacobian = evaluator.Jacobian(i);
    const std::size_t block_idx = static_cast<std::size_t>(residual.block_idxs[i]);
    const int column = structure.column_of_block[block_idx];
    if (block.kind == Kind::kEliminated) {
      AddGramProduct(jacobian, jacobian, eliminated->hessian.data(), eliminated->hessian.cols());
      eliminated->gradient += jacobian.transpose().lazyProduct(evaluator.Residuals());
    } else {
      system->kept_gradient.segment(column, jacobian.cols()) +=
          jacobian.transpose().lazyProduct(evaluator.Residuals());
    }
    for (std::size_t j = 0; j < residual.block_idxs.size(); ++j) {
      if (evaluator.BlockOf(residual, j).kind != Kind::kKept) continue;
      const std::size_t other_idx = static_cast<std::size_t>(residual.block_idxs[j]);
      if (block.kind == Kind::kEliminated) {
        AddGramProduct(jacobian, evaluator.Jacobian(j),
                       eliminated->coupling.data() + columns[other_idx],
                       eliminated->coupling.cols());
      } else {
        AddGramProduct(jacobian, evaluator.Jacobian(j),
                       system->kept_hessian.data() + column * system->kept_hessian.cols() +
                           structure.column_of_block[other_idx],
                       system->kept_hessian.cols());
      }
    }
  }
}

}  // namespace

void KeepCoupledBlocks(SchurProblem* problem) {
  for (const SchurResidual& residual : problem->residuals) {
    std::vector<SchurBlock*> eliminated;
    for (const int block_idx : residual.block_idxs) {
      SchurBlock& block = problem->blocks[static_cast<std::size_t>(block_idx)];
      if (block.kind == Kind::kEliminated) eliminated.push_back(&block);
    }
    if (eliminated.size() < 2) continue;
    for (SchurBlock* block : eliminated) block->kind = Kind::kKept;
  }
}

SchurStructure MakeSchurStructure(const SchurProblem& problem) {
  SchurStructure structure;
  structure.column_of_block.assign(problem.blocks.size(), -1);
  std::vector<int> eliminated_of_block(problem.blocks.size(), -1);
  for (std::size_t idx = 0; idx < problem.blocks.size(); ++idx) {
    const SchurBlock& block = problem.blocks[idx];
    if (block.kind == Kind::kEliminated) {
      eliminated_of_block[idx] = static_cast<int>(structure.eliminated.size());
      structure.eliminated.push_back({static_cast<int>(idx), {}, {}, 0});
    } else if (block.kind == Kind::kKept) {
      structure.column_of_block[idx] = structure.num_kept_columns;
      structure.kept_block_idxs.push_back(static_cast<int>(idx));
      structure.num_kept_columns += block.TangentSize();
    }
  }
  std::vector<std::set<int>> kept_of(structure.eliminated.size());
  for (std::size_t idx = 0; idx < problem.residuals.size(); ++idx) {
    int eliminated_idx = -1;
    for (const int block_idx : problem.residuals[idx].block_idxs) {
      const int candidate = eliminated_of_block[static_cast<std::size_t>(block_idx)];
      if (candidate < 0) continue;
      if (eliminated_idx >= 0) throw std::logic_error("a residual with two eliminated blocks");
      eliminated_idx = candidate;
    }
    if (eliminated_idx < 0) {
      structure.residuals_of_kept.push_back(static_cast<int>(idx));
      continue;
    }
    const std::size_t at = static_cast<std::size_t>(eliminated_idx);
    structure.eliminated[at].residual_idxs.push_back(static_cast<int>(idx));
    for (const int block_idx : problem.residuals[idx].block_idxs) {
      if (structure.column_of_block[static_cast<std::size_t>(block_idx)] >= 0) {
        kept_of[at].insert(block_idx);
      }
    }
  }
  for (std::size_t i = 0; i < kept_of.size(); ++i) {
    SchurStructure::Eliminated& eliminated = structure.eliminated[i];
    eliminated.kept_block_idxs.assign(kept_of[i].begin(), kept_of[i].end());
    for (const int block_idx : eliminated.kept_block_idxs) {
      eliminated.num_columns += problem.blocks[static_cast<std::size_t>(block_idx)].TangentSize();
    }
  }
  return structure;
}

bool Linearise(const SchurProblem& problem, const SchurStructure& structure, SchurSystem* system) {
  Evaluator evaluator(problem);
  evaluator.UpdateManifolds();
  system->cost = 0.0;
  system->kept_hessian.setZero(structure.num_kept_columns, structure.num_kept_columns);
  system->kept_gradient.setZero(structure.num_kept_columns);
  system->eliminated.resize(structure.eliminated.size());
  std::vector<int> columns(problem.blocks.size(), -1);
  const auto add = [&](int residual_idx, SchurSystem::Eliminated* eliminated) {
    const SchurResidual& residual = problem.residuals[static_cast<std::size_t>(residual_idx)];
    if (!evaluator.Evaluate(residual, true)) return false;
    system->cost += evaluator.Cost();
    AddResidual(residual, evaluator, structure, columns, eliminated, system);
    return true;
  };
  for (std::size_t i = 0; i < structure.eliminated.size(); ++i) {
    const SchurStructure::Eliminated& place = structure.eliminated[i];
    SchurSystem::Eliminated& eliminated = system->eliminated[i];
    const int size = problem.blocks[static_cast<std::size_t>(place.block_idx)].TangentSize();
    eliminated.hessian.setZero(size, size);
    eliminated.gradient.setZero(size);
    eliminated.coupling.setZero(size, place.num_columns);
    int column = 0;
    for (const int block_idx : place.kept_block_idxs) {
      columns[static_cast<std::size_t>(block_idx)] = column;
      column += problem.blocks[static_cast<std::size_t>(block_idx)].TangentSize();
    }
    for (const int residual_idx : place.residual_idxs) {
      if (!add(residual_idx, &eliminated)) return false;
    }
  }
  for (const int residual_idx : structure.residuals_of_kept) {
    if (!add(residual_idx, nullptr)) return false;
  }
  return true;
}

double EvaluateCost(const SchurProblem& problem) {
  Evaluator evaluator(problem);
  double cost = 0.0;
  for (const SchurResidual& residual : problem.residuals) {
    if (!evaluator.Evaluate(residual, false)) return std::numeric_limits<double>::infinity();
    cost += evaluator.Cost();
  }
  return cost;
}

bool VisitResiduals(const SchurProblem& problem, const std::vector<int>& residual_idxs,
                    bool with_jacobians, const ResidualVisitor& visit) {
  Evaluator evaluator(problem);
  if (with_jacobians) evaluator.UpdateManifolds();
  for (const int residual_idx : residual_idxs) {
    const SchurResidual& residual = problem.residuals[static_cast<std::size_t>(residual_idx)];
    if (!evaluator.Evaluate(residual, with_jacobians)) return false;
    visit(residual, evaluator.Residuals(), evaluator.Jacobians());
  }
  return true;
}

}  // namespace velamap
