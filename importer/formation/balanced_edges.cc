#include "importer/formation/balanced_edges.h"

#include <algorithm>
#include <cmath>

#include "importer/base/log.h"
#include "importer/formation/edge_shift.h"

namespace velamap {
namespace {

// James and Stein's estimate, positive part: the share of a shift that noise does not explain.
double ShareBeyondNoise(double shift, double sigma) {
  return std::max(0.0, 1 - sigma * sigma / (shift * shift));
}

// The share of a disagreement between inner edges and outlines that the outlines cause. `leverage`
// (1 to 6) is the movement of the corners per px of disagreement if the outlines caused all of it.
// It is larger where the blur mixes small cells, which also makes inner edges less certain. The
// numbers come from draws of workflows/studies/camera_draws.sh and from compressed pictures of
// small markers.
double ShareOfOutlines(double leverage) {
  constexpr double kLargestShare = 0.7, kTurningLeverage = 3.0;
  return kLargestShare / (1 + std::pow(leverage / kTurningLeverage, 4));
}

FormationState WithEdgeShift(double shift_blurs, const FormationState& state,
                             const FitWorkers& workers) {
  FormationVector parameters = state.parameters;
  parameters[kEdgeShift] = std::clamp(shift_blurs, -kMaxEdgeShift, kMaxEdgeShift);
  return MovedTo(parameters, state, workers);
}

FormationState WithOutlineShift(double shift_blurs, const FormationState& state,
                                const FitWorkers& workers) {
  ImageFormationParameters formation = state.formation->parameters();
  formation.outline_shift_blurs = shift_blurs;
  return FittedWith(formation, state.parameters, state, workers);
}

}  // namespace

BalancedEdges WithBalancedEdges(const FormationState& state, const FitWorkers& workers) {
  constexpr int kIterations = 3;
  const double shift = state.parameters[kEdgeShift];
  const double probe_blurs = shift > 0 ? -0.05 : 0.05;  // away from the nearer limit
  FormationState balanced = state;
  EdgeShift edges;
  for (int i = 0; i < kIterations; ++i) {
    edges = InnerEdgeShift(balanced);
    balanced = WithEdgeShift(balanced.parameters[kEdgeShift] + edges.mean_blurs, balanced, workers);
  }
  const double change = balanced.parameters[kEdgeShift] - shift;
  if (change == 0) return {state, 0.0};
  // The change itself may be too small to show how far it moves corners.
  const double outwards_px =
      MeanInset(state, WithEdgeShift(shift + probe_blurs, state, workers)) / probe_blurs;
  const double share = ShareBeyondNoise(change, edges.sigma_blurs);
  LogDebug(
      "inner edges: shift {:+.4f} -> {:+.4f} +- {:.4f} blur sigmas, corners {:.3f} px outwards; "
      "half difference of the directions {:.4f}",
      shift, shift + change, edges.sigma_blurs, outwards_px * change, edges.half_difference_blurs);
  const double unexplained =
      std::sqrt(std::max(0.0, edges.half_difference_blurs * edges.half_difference_blurs -
                                  edges.sigma_blurs * edges.sigma_blurs));
  return {WithEdgeShift(shift + share * change, state, workers),
          std::abs(outwards_px) * std::hypot(share * edges.sigma_blurs, unexplained)};
}

BalancedEdges WithBalancedOutlines(const FormationState& state, const FitWorkers& workers) {
  constexpr double kProbeBlurs = -0.1, kMaxShiftBlurs = 0.5, kMinSlopePx = 0.05;
  constexpr double kSigmaFactor = 1.25;  // what moves outlines moves inner edges as well, a little
  const EdgeShift edges = InnerEdgeShift(state);
  const FormationState probe = WithOutlineShift(kProbeBlurs, state, workers);
  const double slope_px =
      (InnerEdgeShift(probe).corners_outwards_px - edges.corners_outwards_px) / kProbeBlurs;
  if (!(slope_px > kMinSlopePx)) return {state, std::abs(edges.corners_outwards_px)};
  // Two steps of Newton's method.
  const auto stepped = [&](double shift, const EdgeShift& left) {
    return std::clamp(shift - left.corners_outwards_px / slope_px, -kMaxShiftBlurs, kMaxShiftBlurs);
  };
  double shift = stepped(0.0, edges);
  shift = stepped(shift, InnerEdgeShift(WithOutlineShift(shift, state, workers)));
  const double sigma = edges.corners_sigma_px / slope_px;
  const double inset_px = MeanInset(state, probe) / kProbeBlurs;  // by one blur sigma
  const double share = ShareOfOutlines(inset_px / slope_px);
  const double unexplained = shift * ShareBeyondNoise(shift, sigma);
  shift = share * unexplained;
  LogDebug(
      "inner edges have corners {:+.4f} +- {:.4f} px further outside: outlines shifted by {:+.3f} "
      "+- {:.3f} blur sigmas, corners {:+.4f} px outwards",
      edges.corners_outwards_px, edges.corners_sigma_px, shift, sigma, inset_px * shift);
  return {
      WithOutlineShift(shift, state, workers),
      std::abs(inset_px) * std::hypot(shift != 0 ? share * sigma : 0.0,
                                      kSigmaFactor * std::sqrt(share * (1 - share)) * unexplained)};
}

}  // namespace velamap
