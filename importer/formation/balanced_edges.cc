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
    parameters[kInkSpread] =
        std::clamp(parameters[kInkSpread] + edges.mean_sides, -kMaxInkSpread, kMaxInkSpread);
    balanced.state = MovedTo(parameters, balanced.state, num_threads);
  }
  const double change = balanced.state.parameters[kInkSpread] - state.parameters[kInkSpread];
  const double inset_px = MeanInset(state, balanced.state);
  if (std::abs(change) < 1e-7) return {state, 0.0};
  // James and Stein's estimate, positive part: what noise explains is not corrected.
  const double share = std::max(0.0, 1 - edges.sigma_sides * edges.sigma_sides / (change * change));
  FormationVector parameters = state.parameters;
  parameters[kInkSpread] += share * change;
  spdlog::debug(
      "inner edges: ink spread {:+.3f} -> {:+.3f} +- {:.3f} % of the side, corners {:.3f} px "
      "outwards; half difference of the directions {:.3f} %",
      100 * state.parameters[kInkSpread], 100 * balanced.state.parameters[kInkSpread],
      100 * edges.sigma_sides, inset_px, 100 * edges.half_difference_sides);
  const double unexplained =
      std::sqrt(std::max(0.0, edges.half_difference_sides * edges.half_difference_sides -
                                  edges.sigma_sides * edges.sigma_sides));
  const double inset_by_spread_px = inset_px / change;
  return {MovedTo(parameters, state, num_threads),
          std::abs(inset_by_spread_px) * std::hypot(share * edges.sigma_sides, unexplained)};
}

}  // namespace velamap
