#include "workflows/run/camera_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "reconstruct/adjust/camera_adjustment.h"
#include "reconstruct/camera/lens_bend_correction.h"
#include "reconstruct/camera_search.h"

namespace velamap {
namespace {

// The focal length in EXIF may be wrong: cropped pictures and pictures that a program wrote keep
// it.
void CompareWithMetadata(const Camera& guess, const Camera& found) {
  constexpr double kFarOff = 0.1;
  const Camera without = UnknownCamera(guess.width_px, guess.height_px);
  const double claimed_px = MeanFocalLength(guess), focal_px = MeanFocalLength(found);
  if (claimed_px == MeanFocalLength(without)) return;  // no claim
  const auto level =
      std::abs(std::log(focal_px / claimed_px)) > kFarOff ? LogLevel::kWarn : LogLevel::kInfo;
  LogMessage(level, "the pictures show a focal length of {:.0f} px, and EXIF says {:.0f} px{}",
             focal_px, claimed_px,
             level == LogLevel::kWarn
                 ? ": the pictures were cropped, scaled or written by a program; EXIF is not used"
                 : "");
}

bool HasFisheye(const std::map<CameraId, Camera>& cameras) {
  return std::any_of(cameras.begin(), cameras.end(), [](const auto& entry) {
    return entry.second.model == CameraModel::kOpenCVFisheye;
  });
}

}  // namespace

std::map<CameraId, Camera> FindUnknownCameras(const std::map<CameraId, Camera>& guesses,
                                              const Layout& layout,
                                              const CornerErrors& corner_errors,
                                              const RegistrationOptions& registration,
                                              const MarkerAdjustmentOptions& adjustment,
                                              std::vector<DatabaseImage>* images) {
  LogInfo("no calibration: estimating the camera from the pictures");
  std::map<CameraId, Camera> found;
  try {
    found = FindCameras(*images, guesses, layout, corner_errors, registration, adjustment);
  } catch (const DataError& error) {
    throw DataError(error.what() + std::string(kOrWithCalibration));
  }
  for (const auto& [camera_id, camera] : found) {
    CompareWithMetadata(guesses.at(camera_id), camera);
  }
  CorrectForLensBend(found, images);
  return found;
}

void WarnOfFisheye(const MarkerAdjustmentOptions& options, const Layout& layout,
                   const CornerErrors& corner_errors, const Model& seed, const Model& adjusted,
                   const std::optional<AdjustmentUncertainty>& uncertainty) {
  const bool is_contradicted = uncertainty && (IsContradicted(uncertainty->calibration) ||
                                               !(adjusted.cameras == seed.cameras));
  if (!is_contradicted || HasFisheye(seed.cameras)) return;
  try {
    const CameraAdjustment free = AdjustCameras(options, layout, corner_errors, seed);
    if (!HasFisheye(free.cameras)) return;
  } catch (const DataError& error) {
    LogDebug("the lens is not tested: {}", error.what());
    return;
  }
  LogWarning(
      "the residuals are those of a fisheye lens, but the calibration is not a fisheye model: "
      "calibrate the camera as a fisheye (distortion_model: fisheye), or leave --camera_path out, "
      "so that the camera is found");
}

SteadinessVerdict CheckSteadiness(const MarkerAdjustmentOptions& options, const Layout& layout,
                                  const CornerErrors& corner_errors, const Model* seed,
                                  const Model& model) {
  SteadinessVerdict verdict = JudgeSteadiness(model);
  if (verdict.wander) LogWarning(DescribeWander(*verdict.wander));
  verdict.step = ConfirmFocalStep(options, layout, corner_errors, seed, verdict.step);
  if (!verdict.step) return verdict;
  if (seed != nullptr && options.find_camera) {
    throw DataError("the camera cannot be found: " + DescribeStep(*verdict.step));
  }
  LogWarning(DescribeStep(*verdict.step));
  return verdict;
}

}  // namespace velamap
