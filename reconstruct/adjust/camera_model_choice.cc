#include "reconstruct/adjust/camera_model_choice.h"

#include <algorithm>
#include <array>
#include <vector>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "reconstruct/adjust/corner_calibration.h"
#include "reconstruct/geometry/camera_conversion.h"

namespace velamap {
namespace {

constexpr std::array<CameraModel, 4> kModelsOfClips = {CameraModel::kSimpleRadial,
                                                       CameraModel::kRadial, CameraModel::kOpenCV,
                                                       CameraModel::kOpenCVFisheye};

constexpr double kWideRayLength = 0.7;  // tangent; a fisheye is a candidate beyond it

void SetCameraModel(CameraModel model, MarkerSolution* solution) {
  for (auto& [camera_id, camera] : solution->model.cameras) camera = ConvertCamera(camera, model);
  solution->calibration = solution->model.cameras;
}

}  // namespace

bool IsCandidate(CameraModel model, const MarkerSolution& solution) {
  if (model != CameraModel::kOpenCVFisheye) return true;
  const auto& cameras = solution.model.cameras;
  return std::any_of(cameras.begin(), cameras.end(),
                     [](const auto& entry) { return MaxRayLength(entry.second) > kWideRayLength; });
}

bool HasFoldedCamera(const MarkerSolution& solution) {
  const auto& cameras = solution.model.cameras;
  return std::any_of(cameras.begin(), cameras.end(),
                     [](const auto& entry) { return !HasMonotonicDistortion(entry.second); });
}

std::optional<MarkerSolution> RefinedAs(CameraModel model, MarkerSolution trial) {
  try {
    SetCameraModel(model, &trial);
    Minimize(1e-4, &trial);
    CalibrateRobustly(&trial);
    Minimize(1e-5, &trial);
    CalibrateRobustly(&trial);
    return trial;
  } catch (const DataError& error) {
    LogDebug("camera model {}: {}", CameraModelName(model), error.what());
    return std::nullopt;
  }
}

MarkerSolution WithBestCameraModel(const MarkerSolution& solution) {
  std::vector<MarkerSolution> trials;
  for (const CameraModel model : kModelsOfClips) {
    if (!IsCandidate(model, solution)) continue;
    auto trial = RefinedAs(model, solution);
    if (trial) trials.push_back(std::move(*trial));
  }
  if (trials.empty()) return solution;
  if (!std::all_of(trials.begin(), trials.end(), HasFoldedCamera)) {
    trials.erase(std::remove_if(trials.begin(), trials.end(), HasFoldedCamera), trials.end());
  }
  double least_factor = trials.front().weights.corner_factor;
  for (const MarkerSolution& trial : trials) {
    least_factor = std::min(least_factor, trial.weights.corner_factor);
  }
  std::vector<double> sums;
  for (MarkerSolution& trial : trials) {
    trial.weights.corner_factor = least_factor;
    sums.push_back(SumOfSquares(trial));
  }
  const auto nearest =
      static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
  const double correlation = ShapeCorrelationFactor(trials[nearest], *Linearize(trials[nearest]));
  const double per_parameter = 2.0 * correlation * correlation;
  std::size_t best = 0;
  std::vector<double> criteria;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const CameraModel model = trials[i].model.cameras.begin()->second.model;
    const double num_params = static_cast<double>(NumCameraParams(model)) *
                              static_cast<double>(trials[i].model.cameras.size());
    criteria.push_back(sums[i] + per_parameter * num_params);
    LogDebug("camera model {}: sum of squares {:.1f}, {:.0f} parameters at {:.1f} each: {:.1f}",
             CameraModelName(model), sums[i], num_params, per_parameter, criteria[i]);
    if (criteria[i] < criteria[best]) best = i;
  }
  return trials[best];
}

}  // namespace velamap
