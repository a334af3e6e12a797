#include "reconstruct/adjust/camera_adjustment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/base/natural_order.h"
#include "reconstruct/adjust/marker_adjuster.h"
#include "reconstruct/geometry/camera_conversion.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/model/turned_model.h"

namespace velamap {
namespace {

double Explained(const Model& model) {
  constexpr double kTolerance = 5e-4;  // of the larger side
  double explained = 0.0;
  for (const ModelImage& image : model.images) {
    const Camera& camera = model.cameras.at(image.camera_id);
    const double tolerance_px = kTolerance * LargerSide(camera);
    for (const SeenPoint& point : SeenPointsOf(model, image)) {
      const auto x_px = ImageFromCam(camera, image.cam_from_world * point.x_in_world);
      if (!x_px) continue;
      const double relative = (*x_px - point.x_in_image_px).norm() / tolerance_px;
      explained += std::max(0.0, 1.0 - relative * relative);
    }
  }
  return explained;
}

// A single radial term cannot follow a wide lens.
void AddSecondRadialTerm(Model* model) {
  for (auto& [camera_id, camera] : model->cameras) {
    if (camera.model == CameraModel::kSimpleRadial) {
      camera = ConvertCamera(camera, CameraModel::kRadial);
    }
  }
}

CameraAdjustment AdjustTied(const MarkerAdjustmentOptions& free, const Layout& layout,
                            const CornerErrors& corner_errors, Model tied,
                            const TurnedCameras& turned) {
  AddSecondRadialTerm(&tied);
  MarkerAdjuster adjuster(free, layout, corner_errors, std::move(tied));
  adjuster.PrepareSeed();
  adjuster.AdjustFromSeed();
  adjuster.ChooseCameraModel();
  CameraAdjustment adjustment;
  for (const auto& [camera_id, estimate] : adjuster.EstimateCameras()) {
    adjustment.focal_sigmas_px[camera_id] = estimate.sigmas.front();
  }
  Model result = adjuster.ModelAtMiddleRow();
  adjustment.explained = Explained(result);
  UntieTurnedCameras(turned, &result);
  adjustment.cameras = result.cameras;
  return adjustment;
}

// Removes the images that the two groups of focal lengths leave undecided.
void RemoveUndecidedImages(const FocalStep& step, Model* model) {
  if (step.IsInTime()) return;
  const auto undecided = std::stable_partition(
      model->images.begin(), model->images.end(), [&](const ModelImage& image) {
        return step.image_ids_before.count(image.image_id) > 0 ||
               step.image_ids_after.count(image.image_id) > 0;
      });
  for (auto image = undecided; image != model->images.end(); ++image) {
    RemoveFromTracks(*image, model);
  }
  model->images.erase(undecided, model->images.end());
  RemoveShortTracks(model, 2);
}

// Throws DataError if the wanted model fails and another one is far better, which explains why.
void ThrowIfAnotherIsBetter(const std::vector<CameraModelScore>& scores, CameraModel wanted,
                            const DataError& failure) {
  constexpr double kFarBetter = 0.5;
  const auto best = std::min_element(scores.begin(), scores.end(),
                                     [](const CameraModelScore& a, const CameraModelScore& b) {
                                       return a.unseen_error_px < b.unseen_error_px;
                                     });
  const auto taken =
      std::find_if(scores.begin(), scores.end(),
                   [wanted](const CameraModelScore& score) { return score.model == wanted; });
  if (taken == scores.end() || best->model == wanted ||
      best->unseen_error_px > kFarBetter * taken->unseen_error_px) {
    return;
  }
  throw DataError(fmt::format(
      "a {} camera does not describe this lens: it leaves {:.2f} px in unseen pictures, and {} "
      "leaves {:.2f} px; use that one ({})",
      CameraModelName(wanted), taken->unseen_error_px, CameraModelName(best->model),
      best->unseen_error_px, failure.what()));
}

}  // namespace

CameraAdjustment AdjustCameras(const MarkerAdjustmentOptions& options, const Layout& layout,
                               const CornerErrors& corner_errors, const Model& model) {
  MarkerAdjustmentOptions free = options;
  free.find_camera = true;
  free.Check();
  CheckModel(model);
  Model tied = model;
  TurnedCameras turned = TieTurnedCameras(&tied);
  CameraAdjustment best = AdjustTied(free, layout, corner_errors, tied, turned);
  if (!turned.Any()) return best;
  TurnTheOtherWay(&turned, &tied);
  CameraAdjustment other = AdjustTied(free, layout, corner_errors, std::move(tied), turned);
  if (other.explained > best.explained) best = std::move(other);
  return best;
}

CalibrationAdjustment AdjustForCalibration(const MarkerAdjustmentOptions& options,
                                           const Layout& layout, const CornerErrors& corner_errors,
                                           Model model, std::optional<CameraModel> wanted) {
  MarkerAdjustmentOptions free = options;
  free.find_camera = true;
  free.Check();
  CheckModel(model);
  TieTurnedCameras(&model);
  MarkerAdjuster adjuster(free, layout, corner_errors, std::move(model));
  adjuster.PrepareSeed();
  adjuster.AdjustFromSeed();
  CalibrationAdjustment result;
  result.scores = adjuster.CrossValidateCameraModel(wanted);
  try {
    adjuster.Finish();
  } catch (const DataError& error) {
    if (wanted) ThrowIfAnotherIsBetter(result.scores, *wanted, error);
    throw;
  }
  adjuster.WidenCameraSigmas();
  result.model = adjuster.TakeModel();
  result.summary = adjuster.TakeSummary();
  return result;
}

std::optional<FocalStep> MeasureFocalStep(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerErrors& corner_errors,
                                          Model model, FocalStep step) {
  constexpr double kMinChange = 0.01, kMinSigmas = 10.0;
  const TurnedCameras turned = TieTurnedCameras(&model);
  if (const auto found = turned.cameras.find(step.camera_id); found != turned.cameras.end()) {
    step.camera_id = found->second.upright_id;
  }
  const CameraId second_id = model.cameras.rbegin()->first + 1;
  model.cameras[second_id] = model.cameras.at(step.camera_id);
  RemoveUndecidedImages(step, &model);
  for (ModelImage& image : model.images) {
    const bool is_after = step.IsInTime() ? !NaturalLess(image.name, step.first_image_after)
                                          : step.image_ids_after.count(image.image_id) > 0;
    if (image.camera_id == step.camera_id && is_after) image.camera_id = second_id;
  }
  try {
    const CameraAdjustment adjustment = AdjustCameras(options, layout, corner_errors, model);
    const std::map<CameraId, double>& sigmas_px = adjustment.focal_sigmas_px;
    for (const CameraId camera_id : {step.camera_id, second_id}) {
      if (sigmas_px.count(camera_id) == 0) return std::nullopt;  // its images were left out
    }
    step.before_px = MeanFocalLength(adjustment.cameras.at(step.camera_id));
    step.after_px = MeanFocalLength(adjustment.cameras.at(second_id));
    const double change_px = std::abs(step.after_px - step.before_px);
    step.sigmas = change_px / std::hypot(sigmas_px.at(step.camera_id), sigmas_px.at(second_id));
    if (change_px < kMinChange * step.before_px || step.sigmas < kMinSigmas) return std::nullopt;
    return step;
  } catch (const DataError& error) {
    LogDebug("no two cameras: {}", error.what());
    return std::nullopt;
  }
}

std::optional<FocalStep> ConfirmFocalStep(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerErrors& corner_errors,
                                          const Model* seed, const std::optional<FocalStep>& step) {
  if (!step || !step->IsSuspicious()) return std::nullopt;  // a certain step is suspicious as well
  const std::optional<FocalStep> unmeasured = step->IsCertain() ? step : std::nullopt;
  if (seed == nullptr) return unmeasured;
  const auto measured = MeasureFocalStep(options, layout, corner_errors, *seed, *step);
  return measured ? measured : unmeasured;
}

}  // namespace velamap
