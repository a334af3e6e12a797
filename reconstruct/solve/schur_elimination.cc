#include "reconstruct/solve/schur_elimination.h"

#include <algorithm>
#include <iterator>

#include "reconstruct/solve/gram_matrix.h"

namespace velamap {

Eliminator::Eliminator(const SchurProblem& problem, const SchurStructure& structure)
    : problem_(problem), structure_(structure), roots_(structure.eliminated.size()) {
  MakeBatches();
}

bool Eliminator::ComputeStep(const SchurSystem& system, const TangentVector& damping,
                             TangentVector* step) {
  schur_ = system.kept_hessian;
  schur_.diagonal() += damping.kept;
  Eigen::VectorXd right = system.kept_gradient;
  for (Batch& batch : batches_) {
    if (!Reduce(system, damping, &batch)) return false;
    Subtract(batch, &right);
  }
  if (schur_.rows() > 0) {
    root_.compute(schur_.selfadjointView<Eigen::Lower>());
    if (root_.info() != Eigen::Success) return false;
    step->kept = -root_.solve(right);
  } else {
    step->kept.resize(0);
  }
  step->eliminated.resize(structure_.eliminated.size());
  for (const Batch& batch : batches_) Substitute(batch, step);
  return step->kept.allFinite() &&
         std::all_of(step->eliminated.begin(), step->eliminated.end(),
                     [](const Eigen::VectorXd& part) { return part.allFinite(); });
}

void Eliminator::MakeBatches() {
  constexpr Eigen::Index kMaxNumRows = 256;
  constexpr double kMaxFill = 1.25;
  double area = 0.0;
  for (std::size_t i = 0; i < structure_.eliminated.size(); ++i) {
    const SchurStructure::Eliminated& place = structure_.eliminated[i];
    const Eigen::Index size = TangentSize(place.block_idx);
    std::vector<int> kept;
    if (!batches_.empty()) {
      const Batch& last = batches_.back();
      std::set_union(last.kept_block_idxs.begin(), last.kept_block_idxs.end(),
                     place.kept_block_idxs.begin(), place.kept_block_idxs.end(),
                     std::back_inserter(kept));
      const Eigen::Index num_rows = last.row_begins.back() + size;
      const double new_area = area + static_cast<double>(size * place.num_columns);
      if (num_rows <= kMaxNumRows &&
          static_cast<double>(num_rows * NumColumns(kept)) <= kMaxFill * new_area) {
        batches_.back().end = i + 1;
        batches_.back().kept_block_idxs = std::move(kept);
        batches_.back().row_begins.push_back(num_rows);
        area = new_area;
        continue;
      }
    }
    batches_.push_back({i, i + 1, place.kept_block_idxs, {0, size}, {}, {}, {}});
    area = static_cast<double>(size * place.num_columns);
  }
  for (Batch& batch : batches_) {
    batch.column_begins.push_back(0);
    for (const int block_idx : batch.kept_block_idxs) {
      batch.column_begins.push_back(batch.column_begins.back() + TangentSize(block_idx));
    }
  }
}

bool Eliminator::Reduce(const SchurSystem& system, const TangentVector& damping, Batch* batch) {
  batch->coupling.setZero(batch->row_begins.back(), batch->column_begins.back());
  batch->gradient.resize(batch->row_begins.back());
  for (std::size_t i = batch->begin; i < batch->end; ++i) {
    const SchurSystem::Eliminated& eliminated = system.eliminated[i];
    Eigen::MatrixXd hessian = eliminated.hessian;
    hessian.diagonal() += damping.eliminated[i];
    roots_[i].compute(hessian);
    if (roots_[i].info() != Eigen::Success) return false;
    const Eigen::Index begin = batch->row_begins[i - batch->begin], size = hessian.rows();
    const auto& kept = structure_.eliminated[i].kept_block_idxs;
    Eigen::Index from = 0;
    std::size_t in_batch = 0;
    for (const int block_idx : kept) {
      while (batch->kept_block_idxs[in_batch] != block_idx) ++in_batch;
      const Eigen::Index width = TangentSize(block_idx);
      batch->coupling.block(begin, batch->column_begins[in_batch], size, width) =
          eliminated.coupling.middleCols(from, width);
      from += width;
    }
    auto rows = batch->coupling.middleRows(begin, size);
    roots_[i].matrixL().solveInPlace(rows);
    batch->gradient.segment(begin, size) = roots_[i].matrixL().solve(eliminated.gradient);
  }
  return true;
}

void Eliminator::Subtract(const Batch& batch, Eigen::VectorXd* right) {
  if (batch.coupling.cols() == 0) return;
  if (batch.coupling.cols() == schur_.cols()) {
    SubtractGramMatrix(batch.coupling, &schur_);
    *right -= batch.coupling.transpose() * batch.gradient;
    return;
  }
  update_.setZero(batch.coupling.cols(), batch.coupling.cols());
  SubtractGramMatrix(batch.coupling, &update_);
  const Eigen::VectorXd of_gradient = batch.coupling.transpose() * batch.gradient;
  for (std::size_t a = 0; a < batch.kept_block_idxs.size(); ++a) {
    const Eigen::Index from = batch.column_begins[a], width = batch.column_begins[a + 1] - from;
    const int to = Column(batch.kept_block_idxs[a]);
    right->segment(to, width) -= of_gradient.segment(from, width);
    for (std::size_t b = a; b < batch.kept_block_idxs.size(); ++b) {
      const Eigen::Index row = batch.column_begins[b], height = batch.column_begins[b + 1] - row;
      schur_.block(Column(batch.kept_block_idxs[b]), to, height, width) +=
          update_.block(row, from, height, width);
    }
  }
}

void Eliminator::Substitute(const Batch& batch, TangentVector* step) const {
  Eigen::VectorXd kept(batch.coupling.cols());
  for (std::size_t a = 0; a < batch.kept_block_idxs.size(); ++a) {
    const Eigen::Index width = batch.column_begins[a + 1] - batch.column_begins[a];
    kept.segment(batch.column_begins[a], width) =
        step->kept.segment(Column(batch.kept_block_idxs[a]), width);
  }
  const Eigen::VectorXd right = -(batch.gradient + batch.coupling * kept);
  for (std::size_t i = batch.begin; i < batch.end; ++i) {
    const Eigen::Index begin = batch.row_begins[i - batch.begin];
    step->eliminated[i] =
        roots_[i].matrixU().solve(right.segment(begin, roots_[i].matrixLLT().rows()));
  }
}

Eigen::Index Eliminator::NumColumns(const std::vector<int>& block_idxs) const {
  Eigen::Index count = 0;
  for (const int block_idx : block_idxs) count += TangentSize(block_idx);
  return count;
}

int Eliminator::TangentSize(int block_idx) const {
  return problem_.blocks[static_cast<std::size_t>(block_idx)].TangentSize();
}

int Eliminator::Column(int block_idx) const {
  return structure_.column_of_block[static_cast<std::size_t>(block_idx)];
}

}  // namespace velamap
