#include "reconstruct/camera_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/camera/camera_projection.h"
#include "importer/camera/turned_camera.h"
#include "reconstruct/adjust/camera_adjustment.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"

namespace velamap {
namespace {

using Cameras = std::map<CameraId, Camera>;

constexpr double kMinFocal = 0.25, kMaxFocal = 8.0;  // times the larger side
// The markers hardly constrain the focal length if its logarithm has a sigma above this.
constexpr double kVagueLogSigma = 0.1;

// An initial guess of all cameras.
struct Start {
  std::string name;
  Cameras cameras;
};

void ScaleFocalLength(double factor, Camera* camera) {
  for (std::size_t i = 0; i < NumFocalLengths(camera->model); ++i) {
    camera->params[i] = std::clamp(camera->params[i] * factor, kMinFocal * LargerSide(*camera),
                                   kMaxFocal * LargerSide(*camera));
  }
}

Cameras WithFocalTimes(double factor, Cameras cameras) {
  for (auto& [camera_id, camera] : cameras) ScaleFocalLength(factor, &camera);
  return cameras;
}

// Maps each camera to the camera of the upright images if its guess is that camera rotated, else to
// itself.
std::map<CameraId, CameraId> UprightCameras(const Cameras& guesses) {
  std::map<CameraId, CameraId> upright;
  for (const auto& [camera_id, camera] : guesses) {
    upright[camera_id] = camera_id;
    for (const auto& [other_id, other] : guesses) {
      if (other_id >= camera_id) break;
      if (upright.at(other_id) != other_id || !(TurnCamera(other, 1) == camera)) continue;
      upright[camera_id] = other_id;
      break;
    }
  }
  return upright;
}

struct Lens {
  Cameras cameras;
  // 1 sigma of the logarithm of the focal length that all cameras give together.
  double log_sigma = std::numeric_limits<double>::infinity();
  double cost = 0.0;  // sum of FocalEvidence::cost
};

// The views of each upright camera, with those of turned images turned back.
std::map<CameraId, std::vector<SquareView>> UprightViews(
    const std::vector<DatabaseImage>& images, const Cameras& guesses,
    const std::map<CameraId, CameraId>& upright, const MarkerAdjustmentOptions& adjustment) {
  std::map<CameraId, std::vector<SquareView>> views;
  for (const auto& [camera_id, guess] : guesses) {
    std::vector<DatabaseImage> of_camera;
    for (const DatabaseImage& image : images) {
      if (image.camera_id == camera_id) of_camera.push_back(image);
    }
    for (SquareView view : SquaresOf(of_camera, adjustment)) {
      if (upright.at(camera_id) != camera_id) {
        for (Eigen::Vector2d& corner_px : view.corners_px) {
          corner_px = TurnInImage(guess, -1, corner_px);
        }
      }
      views[upright.at(camera_id)].push_back(view);
    }
  }
  return views;
}

// A camera whose markers hardly constrain its focal length gets the weighted mean of all cameras,
// as a fraction of the larger side.
Lens LensOf(CameraModel model, const std::vector<DatabaseImage>& images, const Cameras& guesses,
            const RegistrationOptions& registration, const MarkerAdjustmentOptions& adjustment) {
  const std::map<CameraId, CameraId> upright = UprightCameras(guesses);
  Lens lens;
  double information = 0.0, sum = 0.0;
  std::map<CameraId, double> log_sigmas;
  for (const auto& [camera_id, of_camera] : UprightViews(images, guesses, upright, adjustment)) {
    const Camera& guess = guesses.at(camera_id);
    const FocalEvidence evidence = FindFocalLength(model, guess.width_px, guess.height_px,
                                                   of_camera, registration.num_threads);
    lens.cameras[camera_id] = evidence.camera;
    lens.cost += evidence.cost;
    log_sigmas[camera_id] = evidence.log_sigma;
    if (!std::isfinite(evidence.log_sigma)) continue;
    const double weight = 1.0 / (evidence.log_sigma * evidence.log_sigma);
    information += weight;
    sum += weight * std::log(MeanFocalLength(evidence.camera) / LargerSide(evidence.camera));
  }
  for (auto& [camera_id, camera] : lens.cameras) {
    if (!(information > 0)) break;
    if (log_sigmas[camera_id] < kVagueLogSigma) continue;
    ScaleFocalLength(std::exp(sum / information) * LargerSide(camera) / MeanFocalLength(camera),
                     &camera);
  }
  if (information > 0) lens.log_sigma = 1.0 / std::sqrt(information);
  for (const auto& [camera_id, upright_id] : upright) {
    if (lens.cameras.count(camera_id) > 0) continue;
    lens.cameras[camera_id] = camera_id == upright_id ? guesses.at(camera_id)
                                                      : TurnCamera(lens.cameras.at(upright_id), 1);
  }
  return lens;
}

std::vector<Start> Starts(const std::vector<DatabaseImage>& images, const Cameras& guesses,
                          const RegistrationOptions& registration,
                          const MarkerAdjustmentOptions& adjustment) {
  constexpr double kMaxStep = 0.7;
  const Lens straight =
      LensOf(CameraModel::kSimpleRadial, images, guesses, registration, adjustment);
  const Lens fisheye =
      LensOf(CameraModel::kOpenCVFisheye, images, guesses, registration, adjustment);
  LogInfo(
      "single markers: focal length {:.0f} px +- {:.1f} % (rectilinear lens) or {:.0f} px +- "
      "{:.1f} % (fisheye)",
      MeanFocalLength(straight.cameras.begin()->second), 100.0 * straight.log_sigma,
      MeanFocalLength(fisheye.cameras.begin()->second), 100.0 * fisheye.log_sigma);
  std::vector<Start> starts = {{"straight lines", straight.cameras}, {"fisheye", fisheye.cameras}};
  if (fisheye.cost < straight.cost) std::swap(starts[0], starts[1]);
  starts.push_back({"the database's", guesses});
  if (straight.log_sigma > kVagueLogSigma) {
    const double step = std::min(kMaxStep, 2.0 * straight.log_sigma);
    starts.push_back({"longer", WithFocalTimes(std::exp(step), straight.cameras)});
    starts.push_back({"shorter", WithFocalTimes(std::exp(-step), straight.cameras)});
  }
  return starts;
}

// The largest distance, px, between the images of a ray in both cameras. The rays pass through the
// border of the image of `a`.
double Distance(const Camera& a, const Camera& b) {
  constexpr int kNumSteps = 8;
  double largest_px = 0.0;
  for (int i = 0; i <= kNumSteps; ++i) {
    const double x = static_cast<double>(a.width_px) * i / kNumSteps;
    const double y = static_cast<double>(a.height_px) * i / kNumSteps;
    for (const Eigen::Vector2d& x_px : {Eigen::Vector2d(x, 0), Eigen::Vector2d(x, a.height_px),
                                        Eigen::Vector2d(0, y), Eigen::Vector2d(a.width_px, y)}) {
      const auto ray = CamFromImage(a, x_px);
      if (!ray) continue;
      const auto in_b_px = ImageFromCam(b, ray->homogeneous());
      if (in_b_px) largest_px = std::max(largest_px, (*in_b_px - x_px).norm());
    }
  }
  return largest_px;
}

struct Outcome {
  Cameras cameras;
  double explained = 0.0;
  double share = 0.0;  // `explained` as a fraction of the corners in the registered images
};

class CameraSearch {
 public:
  CameraSearch(const std::vector<DatabaseImage>& images, const Layout& layout,
               const CornerErrors& corner_errors, const RegistrationOptions& registration,
               const MarkerAdjustmentOptions& adjustment)
      : images_(images),
        layout_(layout),
        corner_errors_(corner_errors),
        registration_(registration),
        adjustment_(adjustment) {
    constexpr int kMaxNumFrames = 40;
    registration_.method = RegistrationMethod::kGlobal;
    registration_.has_calibration = false;
    registration_.central_frame.clear();  // a wrong camera may not register it
    registration_.global.max_num_frames =
        std::min(registration.global.max_num_frames, kMaxNumFrames);
  }

  // Throws DataError.
  Outcome Run(const Start& start) const {
    constexpr int kMaxNumRounds = 4;
    constexpr double kSame = 1e-3;           // as a fraction of the larger side
    constexpr double kSameExplained = 5e-3;  // as a fraction of what is explained
    constexpr double kEnough = 0.9;  // share; another round would be the reconstruction itself
    LogInfo("from {}: registering the pictures and adjusting the camera", start.name);
    Outcome outcome = RunOnce(start.cameras);
    for (int round = 1; round < kMaxNumRounds && outcome.share < kEnough; ++round) {
      LogInfo(
          "from {}: once more with a focal length of {:.1f} px, {:.0f} % of the corners explained",
          start.name, MeanFocalLength(outcome.cameras.begin()->second), 100.0 * outcome.share);
      Outcome next;
      try {
        next = RunOnce(outcome.cameras);
      } catch (const DataError& error) {
        LogDebug("not again: {}", error.what());
        break;
      }
      double change = 0.0;
      for (const auto& [camera_id, camera] : next.cameras) {
        const auto before = outcome.cameras.find(camera_id);
        if (before == outcome.cameras.end()) continue;
        change = std::max(change, Distance(camera, before->second) / LargerSide(camera));
      }
      const double gain = next.explained / std::max(outcome.explained, 1e-9) - 1.0;
      if (gain >= 0) outcome = std::move(next);
      if (gain < kSameExplained || change < kSame) break;
    }
    return outcome;
  }

 private:
  Outcome RunOnce(const Cameras& cameras) const {
    const Registration registration = RegisterFrames(images_, cameras, layout_, registration_);
    const Model seed = MakeSeedModel(registration, images_, cameras);
    CameraAdjustment adjustment = AdjustCameras(adjustment_, layout_, corner_errors_, seed);
    Outcome outcome;
    outcome.cameras = cameras;  // keeps cameras none of whose images were registered
    for (const auto& [camera_id, camera] : adjustment.cameras) {
      outcome.cameras[camera_id] = camera;
      LogDebug("camera {}: {} with focal length {:.1f} px", camera_id,
               CameraModelName(camera.model), MeanFocalLength(camera));
    }
    outcome.explained = adjustment.explained;
    std::size_t num_corners = 0;
    for (const ModelImage& image : seed.images) num_corners += image.points2D.size();
    outcome.share = outcome.explained / std::max(1.0, static_cast<double>(num_corners));
    return outcome;
  }

  const std::vector<DatabaseImage>& images_;
  const Layout& layout_;
  const CornerErrors& corner_errors_;
  RegistrationOptions registration_;
  const MarkerAdjustmentOptions& adjustment_;
};

}  // namespace

std::vector<SquareView> SquaresOf(const std::vector<DatabaseImage>& images,
                                  const MarkerAdjustmentOptions& adjustment) {
  std::vector<SquareView> views;
  for (const DatabaseImage& image : images) {
    for (const MarkerDetection& marker : image.detections.markers) {
      if (marker.is_fallback) continue;
      double sum = 0.0;
      for (const double sigma_px : marker.corner_sigma_px) {
        sum += sigma_px > 0 ? sigma_px : adjustment.corner_sigma_px;
      }
      views.push_back({marker.corners_in_image_px,
                       std::hypot(sum / kNumCorners, adjustment.corner_sigma_floor_px)});
    }
  }
  return views;
}

std::map<CameraId, Camera> FindCameras(const std::vector<DatabaseImage>& images,
                                       const std::map<CameraId, Camera>& guesses,
                                       const Layout& layout, const CornerErrors& corner_errors,
                                       const RegistrationOptions& registration,
                                       const MarkerAdjustmentOptions& adjustment) {
  constexpr double kNearlyAll = 0.8;
  if (images.size() < 2) return guesses;  // the registration will report what is missing
  const CameraSearch search(images, layout, corner_errors, registration, adjustment);
  std::optional<Outcome> best;
  std::string first_failure;
  for (const Start& start : Starts(images, guesses, registration, adjustment)) {
    try {
      Outcome outcome = search.Run(start);
      LogInfo("from {}: {:.0f} corners explained, {:.0f} % of those seen", start.name,
              outcome.explained, 100.0 * outcome.share);
      if (!best || outcome.explained > best->explained) best = std::move(outcome);
    } catch (const DataError& error) {
      LogInfo("from {}: {}", start.name, error.what());
      if (first_failure.empty()) first_failure = error.what();
    }
    if (best && best->share > kNearlyAll) break;
  }
  if (best) return best->cameras;
  throw DataError("the camera cannot be found from these pictures: " + first_failure);
}

}  // namespace velamap
