#include "reconstruct/adjust/bent_markers.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "importer/base/log.h"
#include "reconstruct/sizes/bend_evidence.h"
#include "reconstruct/sizes/bent_corners.h"
#include "reconstruct/sizes/marker_curvature.h"

namespace velamap {
namespace {

constexpr double kCostTolerance = 1e-5;  // leaves much less than what is significant

// Treats the sides of bent markers as chords, corrects their corners and minimizes.
void Bend(const ChordSummary& chords, const MarkerState& state,
          const std::vector<RemovedObservation>& removed, MarkerSolution* solution) {
  // 1 sigma of the shortening, as a fraction of it. The neighbours show the curvature between
  // markers, not that of the marker, and the correction of the corners is not exact.
  constexpr double kUnknownShare = 0.25;
  for (const MarkerBlock& marker : state.markers) {
    solution->chords[marker.marker_id] = marker.chords;
  }
  solution->weights.chords_as_scale = kUnknownShare * chords.mean_shortening;
  CorrectForBentMarkers(chords.curvatures_1_m, state, *solution->corner_errors, removed,
                        &solution->model);
  Minimize(kCostTolerance, solution);
}

// Twice the log-likelihood ratio of markers that bend to markers that are stiff, from their
// proportions and from how well both fit the images.
double EvidenceForBend(const ChordSummary& chords, const MarkerSolution& stiff,
                       const MarkerSolution& bent) {
  const auto linearization = Linearize(stiff);
  const BendEvidence by_proportions = FindBendEvidence(
      linearization->state, linearization->covariance, chords.curvatures_1_m, stiff.options);
  const double by_images = SumOfSquares(stiff) - SumOfSquares(bent);
  // The camera search gets here many times.
  LogMessage(stiff.options.find_camera ? LogLevel::kDebug : LogLevel::kInfo,
             "markers follow {:.2f} +- {:.2f} of the curvature of their surface, all of which "
             "shortens their sides by {:.2f} % on average; if they follow all of it, the squared "
             "residuals are {:.0f} less",
             by_proportions.share, by_proportions.sigma, 100 * chords.mean_shortening, by_images);
  return by_images + (2 * by_proportions.share - 1) / std::pow(by_proportions.sigma, 2);
}

void WarnOfBentMarkers(const ChordSummary& chords, MarkerSolution* solution) {
  solution->warnings.push_back(fmt::format(
      "markers that bend with this surface have their corners {:.2f} % closer to each other than "
      "printed on average, {:.2f} % on marker {}, and the result would be larger by as much; the "
      "images do not tell whether they bend or are stiff, so say it with the option bent_markers "
      "(1 or 0)",
      100 * chords.mean_shortening, 100 * chords.largest_shortening, chords.marker_id));
}

}  // namespace

void AdjustToBentMarkers(const std::vector<RemovedObservation>& removed, MarkerSolution* solution) {
  constexpr double kMatters = 5e-4;
  const BentMarkers bent_markers = solution->options.bent_markers;
  if (bent_markers == BentMarkers::kStiff) return;
  MarkerState state = solution->state;
  const ChordSummary chords = SetChords(&state);
  if (chords.curvatures_1_m.empty()) return;
  if (bent_markers == BentMarkers::kBent) return Bend(chords, state, removed, solution);
  if (!(chords.mean_shortening > kMatters)) return;
  MarkerSolution stiff = *solution, bent = *solution;
  Minimize(kCostTolerance, &stiff);
  Bend(chords, state, removed, &bent);
  const double evidence = EvidenceForBend(chords, stiff, bent);
  const double significant = InformationCriterion(1, stiff);
  if (evidence > significant) {
    *solution = std::move(bent);
  } else if (evidence > -significant &&
             chords.mean_shortening > PrintScaleSigma(solution->options, solution->weights)) {
    WarnOfBentMarkers(chords, solution);
  }
}

}  // namespace velamap
