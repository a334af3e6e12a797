#include "reconstruct/adjust/camera_cross_validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "importer/base/log.h"
#include "importer/base/parallel.h"
#include "importer/base/statistics.h"
#include "importer/camera/camera_jacobian.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"
#include "reconstruct/adjust/camera_model_choice.h"
#include "reconstruct/correlation/error_correlation.h"
#include "reconstruct/model/reprojection.h"
#include "reconstruct/problem/rolling_shutter.h"

namespace velamap {
namespace {

constexpr std::array<CameraModel, 6> kModels = {
    CameraModel::kSimplePinhole, CameraModel::kSimpleRadial, CameraModel::kRadial,
    CameraModel::kOpenCV,        CameraModel::kFullOpenCV,   CameraModel::kOpenCVFisheye};
constexpr std::size_t kNumDivisions = 5;

// Residuals of the points of one image, px, as a function of its pose.
class ImagePoseProblem : public LeastSquaresProblem<6> {
 public:
  using Parameters = Rigid3;  // cam_from_world

  ImagePoseProblem(const Camera& camera, const std::vector<SeenPoint>& points)
      : camera_(camera), points_(points) {}

  void Evaluate(const Rigid3& cam_from_world, bool, Equations* equations) const {
    *equations = {};
    for (const SeenPoint& point : points_) {
      const Eigen::Vector3d rotated = cam_from_world.rotation * point.x_in_world;
      const Eigen::Vector3d x_in_cam = rotated + cam_from_world.translation;
      if (!(x_in_cam.z() > 0)) return equations->Reject();
      const ImagePoint image = ImageFromPointWithJacobian(camera_, x_in_cam);
      const Eigen::Vector2d residual_px = image.value_px - point.x_in_image_px;
      equations->Add(ByPoseStep(image.by_point, rotated), residual_px);
    }
  }

  Rigid3 Plus(const Rigid3& pose, const Step& step) const { return PlusPose(pose, step); }

 private:
  const Camera& camera_;
  const std::vector<SeenPoint>& points_;
};

// The errors of the corners of one image.
struct ErrorSum {
  double squares_px2 = 0.0;
  int num_corners = 0;
};

ErrorSum ErrorsOf(const Camera& camera, const std::vector<SeenPoint>& points, const Rigid3& pose) {
  ImagePoseProblem::Equations equations;
  ImagePoseProblem(camera, points).Evaluate(pose, false, &equations);
  return {2.0 * equations.cost(), static_cast<int>(points.size())};
}

double RmsOf(const std::vector<ErrorSum>& sums) {
  ErrorSum total;
  for (const ErrorSum& sum : sums) {
    total.squares_px2 += sum.squares_px2;
    total.num_corners += sum.num_corners;
  }
  return total.num_corners > 0 ? std::sqrt(total.squares_px2 / total.num_corners)
                               : std::numeric_limits<double>::infinity();
}

// The division of each image. Neighbouring images are in different divisions.
std::vector<int> Divisions(const Model& model) {
  std::vector<int> divisions(model.images.size());
  for (std::size_t i = 0; i < divisions.size(); ++i) {
    divisions[i] = static_cast<int>(i % kNumDivisions);
  }
  return divisions;
}

// The solution without the images of one group; `groups` holds the group of each image.
MarkerSolution Without(const MarkerSolution& all, const std::vector<int>& groups,
                       std::size_t group) {
  MarkerSolution some = all;
  std::vector<ModelImage> kept;
  for (std::size_t i = 0; i < all.model.images.size(); ++i) {
    const ModelImage& image = all.model.images[i];
    if (groups[i] != static_cast<int>(group)) {
      kept.push_back(image);
    } else {
      RemoveFromTracks(image, &some.model);
    }
  }
  some.model.images = std::move(kept);
  RemoveShortTracks(&some.model, some.options.min_track_length);
  return some;
}

Model InMiddleRow(const MarkerSolution& solution) {
  Model model = solution.model;
  MoveToMiddleRow(solution.state.rolling_shutter_s, solution.corner_errors->motions, &model);
  return model;
}

std::vector<ErrorSum> ErrorsOfSeen(const MarkerSolution& trial) {
  const Model model = InMiddleRow(trial);
  std::vector<ErrorSum> sums;
  for (const ModelImage& image : model.images) {
    sums.push_back(ErrorsOf(model.cameras.at(image.camera_id), SeenPointsOf(model, image),
                            image.cam_from_world));
  }
  return sums;
}

// Adds the errors of the images that one division leaves out.
void FindErrorsOfUnseen(const MarkerSolution& trial, std::size_t division,
                        std::vector<ErrorSum>* sums) {
  constexpr std::size_t kMinPoints = 4;
  const std::vector<int> divisions = Divisions(trial.model);
  MarkerSolution fitted = Without(trial, divisions, division);
  Minimize(1e-9, &fitted);  // weakly determined parameters must forget these images as well
  const Model model = InMiddleRow(trial);
  LeastSquaresOptions options;
  options.min_relative_decrease = 1e-6;
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    if (divisions[i] != static_cast<int>(division)) continue;
    const ModelImage& image = model.images[i];
    const Camera& camera = fitted.model.cameras.at(image.camera_id);
    const std::vector<SeenPoint> points = SeenPointsOf(fitted.model, image);
    if (points.size() < kMinPoints) continue;
    Rigid3 pose = image.cam_from_world;
    ImagePoseProblem::Equations equations;
    MinimizeSquares(options, ImagePoseProblem(camera, points), &pose, &equations);
    (*sums)[i] = ErrorsOf(camera, points, pose);
  }
}

struct Trial {
  MarkerSolution solution;
  std::vector<ErrorSum> unseen;  // by image
  CameraModelScore score;
};

std::optional<Trial> TryModel(CameraModel model, const MarkerSolution& solution) {
  std::optional<MarkerSolution> refined = RefinedAs(model, solution);
  if (!refined) return std::nullopt;
  Trial trial{std::move(*refined), {}, {model, 0.0, 0.0, false}};
  trial.unseen.resize(trial.solution.model.images.size());
  try {
    // Each minimization is serial, so that nothing depends on the number of threads.
    ParallelFor(kNumDivisions, solution.options.num_threads, [&](std::size_t division) {
      FindErrorsOfUnseen(trial.solution, division, &trial.unseen);
    });
  } catch (const DataError& error) {
    LogDebug("camera model {}: {}", CameraModelName(model), error.what());
    return std::nullopt;
  }
  trial.score.unseen_error_px = RmsOf(trial.unseen);
  trial.score.seen_error_px = RmsOf(ErrorsOfSeen(trial.solution));
  trial.score.is_folded = HasFoldedCamera(trial.solution);
  LogInfo("camera model {}: {:.4f} px in pictures that it has not seen, {:.4f} px in all{}",
          CameraModelName(model), trial.score.unseen_error_px, trial.score.seen_error_px,
          trial.score.is_folded ? ", folds over inside the picture" : "");
  return trial;
}

// Whether a model with more parameters is better by more than chance: by more than 1 sigma of the
// difference, from its scatter over the images.
bool IsBetter(const Trial& trial, const Trial& taken) {
  if (trial.score.is_folded != taken.score.is_folded) return taken.score.is_folded;
  if (!std::isfinite(taken.score.unseen_error_px)) {
    return std::isfinite(trial.score.unseen_error_px);
  }
  std::vector<double> gains_px2;
  for (std::size_t i = 0; i < trial.unseen.size(); ++i) {
    gains_px2.push_back(taken.unseen[i].squares_px2 - trial.unseen[i].squares_px2);
  }
  const Statistics gain = ComputeStatistics(gains_px2);
  return gain.mean * std::sqrt(gain.count) > gain.standard_deviation;
}

}  // namespace

CrossValidation CrossValidateCameraModels(const MarkerSolution& solution,
                                          std::optional<CameraModel> wanted) {
  CrossValidation result;
  std::optional<Trial> taken;
  for (const CameraModel model : kModels) {
    if (model != wanted && !IsCandidate(model, solution)) continue;
    std::optional<Trial> trial = TryModel(model, solution);
    if (!trial) continue;
    result.scores.push_back(trial->score);
    const bool is_taken = wanted ? model == *wanted : !taken || IsBetter(*trial, *taken);
    if (is_taken) taken = std::move(trial);
  }
  if (!taken) {
    throw DataError(
        fmt::format("no {} camera fits these pictures; show more of the board in more pictures",
                    wanted ? CameraModelName(*wanted) : std::string("kind of")));
  }
  result.best = std::move(taken->solution);
  return result;
}

MarkerSolution WithMostFlexibleModel(const MarkerSolution& solution) {
  std::optional<MarkerSolution> best;
  double least_factor = std::numeric_limits<double>::infinity();
  for (const CameraModel model : kModels) {
    if (!IsCandidate(model, solution)) continue;
    std::optional<MarkerSolution> trial = RefinedAs(model, solution);
    if (!trial || trial->weights.corner_factor >= least_factor) continue;
    least_factor = trial->weights.corner_factor;
    best = std::move(trial);
  }
  return best ? std::move(*best) : solution;
}

std::map<CameraId, std::vector<double>> JackknifeCameras(const MarkerSolution& solution) {
  constexpr int kMaxNumGroups = 20;
  const std::vector<int> groups = GroupImages(solution.model, kMaxNumGroups);
  const std::size_t num_groups = std::set<int>(groups.begin(), groups.end()).size();
  std::vector<std::map<CameraId, Camera>> cameras(num_groups);
  ParallelFor(num_groups, solution.options.num_threads, [&](std::size_t group) {
    MarkerSolution fitted = Without(solution, groups, group);
    try {
      Minimize(1e-9, &fitted);
      cameras[group] = std::move(fitted.model.cameras);
    } catch (const DataError& error) {
      LogWarning("the scatter of the camera is estimated without one group of pictures: {}",
                 error.what());
    }
  });
  cameras.erase(std::remove_if(cameras.begin(), cameras.end(),
                               [](const auto& of_group) { return of_group.empty(); }),
                cameras.end());
  const auto count = static_cast<double>(cameras.size());
  std::map<CameraId, std::vector<double>> sigmas;
  if (cameras.size() < 2) return sigmas;
  for (const auto& [camera_id, camera] : solution.model.cameras) {
    for (std::size_t i = 0; i < camera.params.size(); ++i) {
      std::vector<double> values;
      for (const auto& of_group : cameras) values.push_back(of_group.at(camera_id).params[i]);
      const double deviation = ComputeStatistics(values).standard_deviation;
      sigmas[camera_id].push_back(deviation * (count - 1.0) / std::sqrt(count));
    }
  }
  return sigmas;
}

}  // namespace velamap
