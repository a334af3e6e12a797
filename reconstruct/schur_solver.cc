#include "reconstruct/schur_solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <Eigen/Cholesky>

#include "importer/error.h"
#include "reconstruct/gram_matrix.h"

namespace velamap {
namespace {

using Kind = SchurBlock::Kind;

// One value for every tangent of the eliminated blocks, block by block, and of the kept ones.
struct TangentVector {
  std::vector<Eigen::VectorXd> eliminated;
  Eigen::VectorXd kept;
};

template <typename Function>
void ForEachPart(const SchurSystem& system, TangentVector* vector, const Function& function) {
  vector->eliminated.resize(system.eliminated.size());
  for (std::size_t i = 0; i < system.eliminated.size(); ++i) {
    function(system.eliminated[i].hessian.diagonal(), i, &vector->eliminated[i]);
  }
  function(system.kept_hessian.diagonal(), system.eliminated.size(), &vector->kept);
}

const Eigen::VectorXd& Part(const TangentVector& vector, std::size_t i) {
  return i < vector.eliminated.size() ? vector.eliminated[i] : vector.kept;
}

// As if the columns of the first Jacobian had been divided by 1 + their norms.
TangentVector SquaredScales(const SchurSystem& system) {
  TangentVector scales;
  ForEachPart(system, &scales, [](const auto& diagonal, std::size_t, Eigen::VectorXd* part) {
    *part = (1.0 + diagonal.array().max(0.0).sqrt()).square().inverse();
  });
  return scales;
}

TangentVector Damping(const SchurSystem& system, const TangentVector& squared_scales,
                      double radius) {
  constexpr double kMinDiagonal = 1e-6, kMaxDiagonal = 1e32;
  TangentVector damping;
  ForEachPart(system, &damping, [&](const auto& diagonal, std::size_t i, Eigen::VectorXd* part) {
    const auto scales = Part(squared_scales, i).array();
    *part = (diagonal.array() * scales).max(kMinDiagonal).min(kMaxDiagonal) / (radius * scales);
  });
  return damping;
}

double Dot(const TangentVector& a, const TangentVector& b) {
  double sum = a.kept.dot(b.kept);
  for (std::size_t i = 0; i < a.eliminated.size(); ++i) {
    sum += a.eliminated[i].dot(b.eliminated[i]);
  }
  return sum;
}

TangentVector Gradient(const SchurSystem& system) {
  TangentVector gradient;
  for (const auto& eliminated : system.eliminated)
    gradient.eliminated.push_back(eliminated.gradient);
  gradient.kept = system.kept_gradient;
  return gradient;
}

double MaxNorm(const TangentVector& vector) {
  double norm = vector.kept.size() > 0 ? vector.kept.lpNorm<Eigen::Infinity>() : 0.0;
  for (const Eigen::VectorXd& part : vector.eliminated) {
    norm = std::max(norm, part.lpNorm<Eigen::Infinity>());
  }
  return norm;
}

// Solves the damped normal equations. Eliminated blocks that share most of their kept ones go
// together: a product of large matrices is several times as fast as many of small ones.
class Eliminator {
 public:
  Eliminator(const SchurProblem& problem, const SchurStructure& structure)
      : problem_(problem), structure_(structure), roots_(structure.eliminated.size()) {
    MakeBatches();
  }

  bool ComputeStep(const SchurSystem& system, const TangentVector& damping, TangentVector* step) {
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

 private:
  struct Batch {
    std::size_t begin = 0, end = 0;  // of the eliminated blocks
    std::vector<int> kept_block_idxs;
    std::vector<Eigen::Index> row_begins, column_begins;  // with the end
    // With D = L L^T by block: L^-1 W and L^-1 g.
    SchurSystem::RowMajor coupling;
    Eigen::VectorXd gradient;
  };

  void MakeBatches() {
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

  bool Reduce(const SchurSystem& system, const TangentVector& damping, Batch* batch) {
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

  // S -= W^T D^-1 W and h -= W^T D^-1 g.
  void Subtract(const Batch& batch, Eigen::VectorXd* right) {
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

  // x = -D^-1 (g + W y)
  void Substitute(const Batch& batch, TangentVector* step) const {
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

  Eigen::Index NumColumns(const std::vector<int>& block_idxs) const {
    Eigen::Index count = 0;
    for (const int block_idx : block_idxs) count += TangentSize(block_idx);
    return count;
  }
  int TangentSize(int block_idx) const {
    return problem_.blocks[static_cast<std::size_t>(block_idx)].TangentSize();
  }
  int Column(int block_idx) const {
    return structure_.column_of_block[static_cast<std::size_t>(block_idx)];
  }

  const SchurProblem& problem_;
  const SchurStructure& structure_;
  std::vector<Batch> batches_;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> roots_;
  Eigen::MatrixXd schur_, update_;
  Eigen::LLT<Eigen::MatrixXd> root_;
};

Eigen::VectorXd Values(const SchurProblem& problem) {
  Eigen::Index size = 0;
  for (const SchurBlock& block : problem.blocks) {
    if (block.kind != Kind::kConstant) size += block.size;
  }
  Eigen::VectorXd values(size);
  Eigen::Index at = 0;
  for (const SchurBlock& block : problem.blocks) {
    if (block.kind == Kind::kConstant) continue;
    values.segment(at, block.size) = Eigen::Map<const Eigen::VectorXd>(block.values, block.size);
    at += block.size;
  }
  return values;
}

void SetValues(const SchurProblem& problem, const Eigen::VectorXd& values) {
  Eigen::Index at = 0;
  for (const SchurBlock& block : problem.blocks) {
    if (block.kind == Kind::kConstant) continue;
    Eigen::Map<Eigen::VectorXd>(block.values, block.size) = values.segment(at, block.size);
    at += block.size;
  }
}

void Move(const SchurProblem& problem, const SchurStructure& structure, const TangentVector& step) {
  std::vector<double> moved;
  const auto move = [&](int block_idx, const double* delta) {
    const SchurBlock& block = problem.blocks[static_cast<std::size_t>(block_idx)];
    moved.resize(static_cast<std::size_t>(block.size));
    if (block.manifold == nullptr) {
      for (int i = 0; i < block.size; ++i) block.values[i] += delta[i];
      return;
    }
    VELAMAP_CHECK(block.manifold->Plus(block.values, delta, moved.data()));
    std::copy(moved.begin(), moved.end(), block.values);
  };
  for (std::size_t i = 0; i < structure.eliminated.size(); ++i) {
    move(structure.eliminated[i].block_idx, step.eliminated[i].data());
  }
  for (const int block_idx : structure.kept_block_idxs) {
    move(block_idx,
         step.kept.data() + structure.column_of_block[static_cast<std::size_t>(block_idx)]);
  }
}

// Size of the region in which a step is trusted.
struct TrustRegion {
  double radius = 1e4;
  double decrease_factor = 2.0;

  void Accept(double quality) {
    constexpr double kMaxRadius = 1e16;
    radius =
        std::min(kMaxRadius, radius / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * quality - 1.0, 3)));
    decrease_factor = 2.0;
  }
  void Reject() {
    radius /= decrease_factor;
    decrease_factor *= 2.0;
  }
};

}  // namespace

SchurSummary SolveSchur(const SchurSolverOptions& options, const SchurProblem& problem) {
  constexpr double kMinQuality = 1e-3, kMinRadius = 1e-32;
  constexpr int kMaxNumInvalidSteps = 5;
  const SchurStructure structure = MakeSchurStructure(problem);
  SchurSummary summary;
  SchurSystem system;
  if (!Linearise(problem, structure, &system)) return summary;
  summary.initial_cost = summary.final_cost = system.cost;
  const TangentVector squared_scales = SquaredScales(system);
  Eliminator eliminator(problem, structure);
  TrustRegion region;
  region.radius = options.initial_radius;
  Eigen::VectorXd values = Values(problem);
  const Eigen::VectorXd initial_values = values;
  int num_invalid_steps = 0;
  while (summary.num_iterations < options.max_num_iterations && region.radius > kMinRadius) {
    const TangentVector gradient = Gradient(system);
    if (MaxNorm(gradient) <= options.gradient_tolerance) break;
    ++summary.num_iterations;
    const TangentVector damping = Damping(system, squared_scales, region.radius);
    TangentVector step;
    double expected_decrease = 0.0;
    if (eliminator.ComputeStep(system, damping, &step)) {
      // -g s - s H s / 2, where (H + damping) s = -g.
      TangentVector damped = step;
      for (std::size_t i = 0; i < step.eliminated.size(); ++i) {
        damped.eliminated[i].array() *= damping.eliminated[i].array();
      }
      damped.kept.array() *= damping.kept.array();
      expected_decrease = 0.5 * (Dot(step, damped) - Dot(gradient, step));
    }
    if (!(expected_decrease > 0.0)) {
      if (++num_invalid_steps > kMaxNumInvalidSteps) {
        SetValues(problem, initial_values);
        return summary;
      }
      region.radius *= 0.5;
      continue;
    }
    num_invalid_steps = 0;
    Move(problem, structure, step);
    const double cost = EvaluateCost(problem), decrease = system.cost - cost;
    const Eigen::VectorXd moved = Values(problem);
    const bool is_last =
        (moved - values).norm() <=
            options.parameter_tolerance * (values.norm() + options.parameter_tolerance) ||
        std::abs(decrease) <= options.function_tolerance * system.cost;
    if (is_last ? decrease > 0.0 : decrease > kMinQuality * expected_decrease) {
      summary.final_cost = cost;
      values = moved;
      if (is_last) break;
      region.Accept(decrease / expected_decrease);
      if (summary.num_iterations < options.max_num_iterations) {
        VELAMAP_CHECK(Linearise(problem, structure, &system));
      }
    } else {
      SetValues(problem, values);
      if (is_last) break;
      region.Reject();
    }
  }
  summary.is_usable = true;
  return summary;
}

}  // namespace velamap
