#include "reconstruct/adjust/found_cameras.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/camera/camera_projection.h"
#include "reconstruct/adjust/camera_model_choice.h"
#include "reconstruct/geometry/intrinsics_prior.h"
#include "reconstruct/problem/marker_uncertainty.h"

namespace velamap {

std::map<CameraId, EstimatedCamera> CamerasOf(const Model& model,
                                              const MarkerLinearization& linearization) {
  std::map<CameraId, EstimatedCamera> cameras;
  for (const auto& [camera_id, camera] : model.cameras) {
    const auto intrinsics = linearization.state.intrinsics.find(camera_id);
    if (intrinsics == linearization.state.intrinsics.end()) continue;  // its images were left out
    const Eigen::VectorXd variances =
        GlobalCovariance(linearization.problem, linearization.covariance, intrinsics->second.data())
            .diagonal();
    cameras[camera_id] = {camera, std::vector<double>(camera.params.size(), 0.0)};
    const std::vector<int> free = UnknownCameraPrior(camera).free;
    for (std::size_t i = 0; i < free.size(); ++i) {
      cameras[camera_id].sigmas[static_cast<std::size_t>(free[i])] =
          std::sqrt(variances[static_cast<Eigen::Index>(i)]);
    }
  }
  return cameras;
}

void WidenToOpenCV(const MarkerSolution& solution, std::map<CameraId, EstimatedCamera>* cameras) {
  const auto has_fewer_parameters = [](const auto& entry) {
    return entry.second.model == CameraModel::kSimpleRadial ||
           entry.second.model == CameraModel::kRadial;
  };
  const auto& chosen = solution.model.cameras;
  if (!std::all_of(chosen.begin(), chosen.end(), has_fewer_parameters)) return;
  std::optional<MarkerSolution> full = RefinedAs(CameraModel::kOpenCV, solution);
  if (!full) return;
  full->weights.corner_factor = solution.weights.corner_factor;
  for (const auto& [camera_id, estimate] : CamerasOf(full->model, *Linearize(*full))) {
    const auto found = cameras->find(camera_id);
    if (found == cameras->end()) continue;
    // OPENCV has a second focal length before the principal point.
    std::vector<double>& sigmas = found->second.sigmas;
    for (std::size_t i = 1; i < sigmas.size(); ++i) {
      sigmas[i] = std::max(sigmas[i], estimate.sigmas[i + 1]);
    }
  }
}

void CheckFocalLength(const std::map<CameraId, EstimatedCamera>& cameras,
                      const std::string& weakness) {
  constexpr double kMaxSigma = 0.05;  // relative
  for (const auto& [camera_id, found] : cameras) {
    const double focal_px = found.camera.params.front(), sigma_px = found.sigmas.front();
    if (sigma_px <= kMaxSigma * focal_px) continue;
    throw DataError(fmt::format(
        "these pictures do not determine the focal length of their camera ({:.0f} +- {:.0f} "
        "px){}{}; film the markers tilted, from near and far and from more sides",
        focal_px, sigma_px, weakness.empty() ? "" : ": ", weakness));
  }
}

void AddInset(double inset_as_scale, const Camera& camera, std::vector<double>* sigmas) {
  const std::size_t num_focal = NumFocalLengths(camera.model);
  for (std::size_t i = 0; i < num_focal; ++i) {
    (*sigmas)[i] = std::hypot((*sigmas)[i], inset_as_scale * camera.params[i]);
  }
}

}  // namespace velamap
