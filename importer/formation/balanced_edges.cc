#include "importer/formation/balanced_edges.h"

#include <algorithm>
#include <cmath>

#include <spdlog/spdlog.h>

#include "importer/formation/edge_shift.h"

namespace velamap {

BalancedEdges WithBalancedEdges(const FormationState& state, int num_threads) {
  constexpr int kIterations = 3;
  BalancedEdges balanced{state, 0.0};
  EdgeShift edges;
  for (int i = 0; i < kIterations; ++i) {
    edges = InnerEdgeShift(balanced.state);
    FormationVector parameters = balanced.state.parameters;
    parameters[kEdgeShift] =
        std::clamp(parameters[kEdgeShift] + edges.mean_blurs, -kMaxEdgeShift, kMaxEdgeShift);
    balanced.state = MovedTo(parameters, balanced.state, num_threads);
  }
  const double change = balanced.state.parameters[kEdgeShift] - state.parameters[kEdgeShift];
  const double inset_px = MeanInset(state, balanced.state);
  if (std::abs(change) < 1e-7) return {state, 0.0};
  // James and Stein's estimate, positive part: what noise explains is not corrected.
  const double share = std::max(0.0, 1 - edges.sigma_blurs * edges.sigma_blurs / (change * change));
  FormationVector parameters = state.parameters;
  parameters[kEdgeShift] += share * change;
  spdlog::debug(
      "inner edges: shift {:+.4f} -> {:+.4f} +- {:.4f} blur sigmas, corners {:.3f} px outwards; "
      "half difference of the directions {:.4f}",
      state.parameters[kEdgeShift], balanced.state.parameters[kEdgeShift], edges.sigma_blurs,
      inset_px, edges.half_difference_blurs);
  const double unexplained =
      std::sqrt(std::max(0.0, edges.half_difference_blurs * edges.half_difference_blurs -
                                  edges.sigma_blurs * edges.sigma_blurs));
  const double inset_by_shift_px = inset_px / change;
  return {MovedTo(parameters, state, num_threads),
          std::abs(inset_by_shift_px) * std::hypot(share * edges.sigma_blurs, unexplained)};
}

}  // namespace velamap
