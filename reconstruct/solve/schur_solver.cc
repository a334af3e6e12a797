#include "reconstruct/solve/schur_solver.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "importer/base/error.h"
#include "reconstruct/solve/schur_elimination.h"

namespace velamap {
namespace {

using Kind = SchurBlock::Kind;

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
