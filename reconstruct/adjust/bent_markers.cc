#include "reconstruct/adjust/bent_markers.h"

#include <cmath>

#include <fmt/format.h>

#include "importer/base/log.h"
#include "reconstruct/sizes/bend_evidence.h"
#include "reconstruct/sizes/bent_corners.h"
#include "reconstruct/sizes/marker_curvature.h"

namespace velamap {
namespace {

// Whether the markers bend, by their proportions; kAuto where these cannot tell.
BentMarkers DecideByProportions(const ChordSummary& chords, const MarkerSolution& solution) {
  constexpr double kMinSigmas = 2.0;
  const auto linearization = Linearize(solution);
  const BendEvidence evidence = FindBendEvidence(linearization->state, linearization->covariance,
                                                 chords.curvatures_1_m, solution.options);
  // The search for a camera tries many times.
  LogMessage(solution.options.find_camera ? LogLevel::kDebug : LogLevel::kInfo,
             "markers follow {:.2f} +- {:.2f} of the curvature of their surface, all of which "
             "shortens their sides by {:.2f} % on average",
             evidence.share, evidence.sigma, 100 * chords.mean_shortening);
  const double from_middle = evidence.share - 0.5;
  if (!(std::abs(from_middle) > kMinSigmas * evidence.sigma)) return BentMarkers::kAuto;
  return from_middle > 0 ? BentMarkers::kBent : BentMarkers::kStiff;
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
  // Of the shortening: neighbours show the curvature between markers, not that of the marker, and
  // the correction of the corners is not exact.
  constexpr double kUnknownShare = 0.25;
  constexpr double kMatters = 5e-4;
  BentMarkers bent_markers = solution->options.bent_markers;
  if (bent_markers == BentMarkers::kStiff) return;
  MarkerState state = solution->state;
  const ChordSummary chords = SetChords(&state);
  if (bent_markers == BentMarkers::kAuto) {
    if (!(chords.mean_shortening > kMatters)) return;
    bent_markers = DecideByProportions(chords, *solution);
    const double print_sigma = PrintScaleSigma(solution->options, solution->weights);
    if (bent_markers == BentMarkers::kAuto && chords.mean_shortening > print_sigma) {
      WarnOfBentMarkers(chords, solution);
    }
    if (bent_markers != BentMarkers::kBent) return;
  }
  if (chords.curvatures_1_m.empty()) return;
  for (const MarkerBlock& marker : state.markers) {
    solution->chords[marker.marker_id] = marker.chords;
  }
  solution->weights.chords_as_scale = kUnknownShare * chords.mean_shortening;
  CorrectForBentMarkers(chords.curvatures_1_m, state, *solution->corner_errors, removed,
                        &solution->model);
  Minimize(1e-3, solution);
}

}  // namespace velamap
