#include "reconstruct/adjust/rolling_shutter_choice.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "reconstruct/adjust/corner_calibration.h"
#include "reconstruct/colmap/observation_filter.h"
#include "reconstruct/problem/marker_uncertainty.h"

namespace velamap {
namespace {

// No sensor with a rolling shutter reads faster. Cloth that flaps or bends may look like a shorter
// readout time.
constexpr double kFastest_s = 1e-3;

// Removes corners that fitted only while the motion counted as a part of their errors.
void RemoveTrialOutliers(MarkerSolution* trial) {
  std::vector<RemovedObservation> removed;
  std::vector<ImageId> removed_images;
  RemoveOutliers(ResidualsOfModel(trial->model, *trial), trial->options.outlier_sigmas,
                 &trial->model, &removed);
  if (removed.empty()) return;
  RemoveUnderconstrained(trial->options.min_track_length, &trial->model, &removed_images);
  Minimize(1e-4, trial);
}

// Whether a trial with the readout time as a parameter determines it. Throws DataError if the trial
// fails.
bool IsDetermined(MarkerSolution trial) {
  trial.weights.frees_rolling_shutter = true;
  Minimize(1e-4, &trial);
  // The sigmas of the corners still contain the motion.
  CalibrateRobustly(&trial);
  Minimize(1e-4, &trial);
  RemoveTrialOutliers(&trial);
  const auto linearization = Linearize(trial);
  const MarkerState& state = linearization->state;
  const double variance = GlobalCovariance(linearization->problem, linearization->covariance,
                                           &state.rolling_shutter_s)(0, 0);
  const double sigma_s =
      std::max(std::sqrt(variance) * ShapeCorrelationFactor(trial, *linearization),
               ShutterSigma(std::sqrt(variance), trial, *linearization));
  const double sigmas = state.rolling_shutter_s / sigma_s;
  const bool is_determined = sigmas * sigmas > InformationCriterion(1, trial) &&
                             std::abs(state.rolling_shutter_s) > kFastest_s;
  // The camera search gets here many times.
  LogMessage(trial.options.find_camera ? LogLevel::kDebug : LogLevel::kInfo,
             "the motion {} a rolling shutter: {:.2f} +- {:.2f} ms from the first row to the last",
             is_determined ? "shows" : "does not show", 1e3 * state.rolling_shutter_s,
             1e3 * sigma_s);
  return is_determined;
}

}  // namespace

bool ShowsRollingShutter(const MarkerSolution& solution) {
  const MarkerAdjustmentOptions& options = solution.options;
  if (!options.estimate_rolling_shutter || options.rolling_shutter_s != 0) return false;
  if (solution.corner_errors->motions.empty()) return false;
  try {
    return IsDetermined(solution);
  } catch (const DataError& error) {
    LogDebug("the rolling shutter cannot be tested: {}", error.what());
    return false;
  }
}

void WarnOfSlowShutter(const AdjustmentUncertainty& uncertainty, MarkerSolution* solution) {
  constexpr double kSlowest_s = 0.04;  // a frame at 25 frames a second
  if (!(std::abs(uncertainty.rolling_shutter_s) > kSlowest_s)) return;
  solution->warnings.push_back(fmt::format(
      "the rows of a frame seem to be read over {:.0f} +- {:.0f} ms, longer than cameras take: is "
      "the video stabilized, slowed down or sped up? Film without stabilization, at normal speed",
      1e3 * std::abs(uncertainty.rolling_shutter_s), 1e3 * uncertainty.rolling_shutter_sigma_s));
}

}  // namespace velamap
