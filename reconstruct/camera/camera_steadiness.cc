#include "reconstruct/camera/camera_steadiness.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "importer/base/natural_order.h"
#include "importer/base/statistics.h"
#include "importer/camera/camera_jacobian.h"
#include "importer/camera/camera_projection.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

constexpr int kNumUnknowns = 9;  // pose, logarithm of the focal length, principal point
constexpr int kMinCornersOfView = 8;

struct OwnCamera {
  Rigid3 cam_from_world;
  Eigen::Vector3d change = Eigen::Vector3d::Zero();  // log focal, offset of the principal point
};

class OwnCameraProblem : public LeastSquaresProblem<kNumUnknowns> {
 public:
  using Parameters = OwnCamera;

  OwnCameraProblem(const Camera& camera, const std::vector<SeenPoint>& points, double scale_px)
      : camera_(camera),
        center_(camera.params[NumFocalLengths(camera.model)],
                camera.params[NumFocalLengths(camera.model) + 1]),
        points_(points),
        loss_{9.0 * scale_px * scale_px} {}

  void Evaluate(const OwnCamera& own, bool, Equations* equations) const {
    *equations = {};
    const double factor = std::exp(own.change.x());
    for (const SeenPoint& point : points_) {
      const Eigen::Vector3d rotated = own.cam_from_world.rotation * point.x_in_world;
      const Eigen::Vector3d x = rotated + own.cam_from_world.translation;
      if (!(x.z() > 0)) return equations->Reject();
      const ImagePoint image = ImageFromPointWithJacobian(camera_, x);
      const Eigen::Vector2d from_center = factor * (image.value_px - center_);
      const Eigen::Vector2d residual =
          center_ + own.change.tail<2>() + from_center - point.x_in_image_px;
      Eigen::Matrix<double, 2, kNumUnknowns> jacobian;
      jacobian.leftCols<6>() = factor * ByPoseStep(image.by_point, rotated);
      jacobian.col(6) = from_center;
      jacobian.rightCols<2>().setIdentity();
      equations->Add(jacobian, residual, loss_);
    }
  }

  OwnCamera Plus(const OwnCamera& own, const Step& step) const {
    return {PlusPose(own.cam_from_world, step.head<6>()), own.change + step.tail<3>()};
  }

 private:
  const Camera& camera_;
  Eigen::Vector2d center_;
  const std::vector<SeenPoint>& points_;
  CauchyLoss loss_;
};

std::optional<ImageIntrinsics> IntrinsicsOf(const Model& model, const ModelImage& image,
                                            double scale_px) {
  const std::vector<SeenPoint> points = SeenPointsOf(model, image);
  if (points.size() < kMinCornersOfView) return std::nullopt;
  const OwnCameraProblem problem(model.cameras.at(image.camera_id), points, scale_px);
  OwnCamera own{image.cam_from_world};
  OwnCameraProblem::Equations equations;
  LeastSquaresOptions options;
  options.max_iterations = 30;
  options.min_relative_decrease = 1e-6;
  if (MinimizeSquares(options, problem, &own, &equations) == Convergence::kFailed) {
    return std::nullopt;
  }
  problem.Evaluate(own, true, &equations);
  const Eigen::FullPivLU<OwnCameraProblem::Equations::Matrix> lu(equations.hessian());
  if (!lu.isInvertible()) return std::nullopt;
  constexpr double kTiny = 1e-30;  // of exact corners
  const Eigen::Matrix3d covariance = lu.inverse().bottomRightCorner<3, 3>();
  const double explained = 0.5 * own.change.dot(covariance.inverse() * own.change);
  const double redundancy = 2.0 * static_cast<double>(points.size()) - kNumUnknowns;
  const double variance = 2.0 * equations.cost() / redundancy;
  const Eigen::Vector3d sigmas = (variance * covariance.diagonal()).cwiseMax(0.0).cwiseSqrt();
  return ImageIntrinsics{
      image.image_id,   own.change.x(),
      sigmas.x(),       own.change.tail<2>(),
      sigmas.tail<2>(), explained / std::max(explained + equations.cost(), kTiny)};
}

// A typical residual of the model, px.
double TypicalError(const Model& model) {
  std::vector<double> errors;
  for (const auto& [point3D_id, point] : model.points3D) errors.push_back(point.mean_error_px);
  constexpr double kMin_px = 1e-3;
  return errors.empty() ? 1.0 : std::max(kMin_px, Median(std::move(errors)));
}

// Weighted mean of [begin, end) with its sigma, and the sum of squared deviations in sigmas.
struct Level {
  double mean = 0.0, sigma = 0.0, squares = 0.0;
};

Level LevelOf(const std::vector<ImageIntrinsics>& values, std::size_t begin, std::size_t end) {
  // Covers the errors of the points, which the sigmas of single images do not include.
  constexpr double kLeastSigma = 2e-3;
  const auto variance = [&](std::size_t i) {
    return std::pow(values[i].log_focal_sigma, 2) + kLeastSigma * kLeastSigma;
  };
  Level level;
  double weights = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    level.mean += values[i].log_focal / variance(i);
    weights += 1.0 / variance(i);
  }
  level.mean /= weights;
  level.sigma = 1.0 / std::sqrt(weights);
  for (std::size_t i = begin; i < end; ++i) {
    level.squares += std::pow(values[i].log_focal - level.mean, 2) / variance(i);
  }
  return level;
}

// By how much the scatter of two groups exceeds the sigmas of their images; at least 1.
double ExcessScatter(const Level& first, const Level& second, std::size_t num_values) {
  return std::max(
      1.0, (first.squares + second.squares) / std::max(1.0, static_cast<double>(num_values) - 2));
}

// How far the values before index `i` are from the others, in scatters of a single value.
double Separation(const std::vector<ImageIntrinsics>& values, std::size_t i) {
  const Level first = LevelOf(values, 0, i), second = LevelOf(values, i, values.size());
  // The mean variance of a group, from the sigma of its mean.
  const double variance =
      0.5 * (static_cast<double>(i) * first.sigma * first.sigma +
             static_cast<double>(values.size() - i) * second.sigma * second.sigma);
  return std::abs(second.mean - first.mean) /
         std::sqrt(variance * ExcessScatter(first, second, values.size()));
}

// The step that best divides the images into those before one image and those from it on. If the
// values on both sides scatter more than their sigmas, the scatter replaces the sigmas.
std::optional<FocalStep> FindStep(const Model& model, const std::vector<ImageIntrinsics>& values) {
  constexpr std::size_t kMinImages = 2;
  std::optional<FocalStep> largest;
  for (std::size_t i = kMinImages; i + kMinImages <= values.size(); ++i) {
    const Level first = LevelOf(values, 0, i), second = LevelOf(values, i, values.size());
    const double sigmas = std::abs(second.mean - first.mean) /
                          (std::sqrt(ExcessScatter(first, second, values.size())) *
                           std::hypot(first.sigma, second.sigma));
    if (largest && sigmas <= largest->sigmas) continue;
    const ModelImage& image = *model.FindImage(values[i].image_id);
    const double focal_px = MeanFocalLength(model.cameras.at(image.camera_id));
    largest = FocalStep{image.name, image.camera_id, focal_px * std::exp(first.mean),
                        focal_px * std::exp(second.mean), sigmas};
  }
  return largest;
}

// The two groups that the focal lengths of the images form, if they do and the images of one group
// do not all follow those of the other. `values` is in the order of time.
std::optional<FocalStep> FindGroups(const Model& model,
                                    const std::vector<ImageIntrinsics>& values) {
  constexpr std::size_t kMinImages = 3;
  constexpr double kMinSeparation = 5.0;
  std::vector<ImageIntrinsics> sorted = values;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.log_focal < b.log_focal; });
  std::size_t best = 0;
  double largest = kMinSeparation;
  for (std::size_t i = kMinImages; i + kMinImages <= sorted.size(); ++i) {
    const double separation = Separation(sorted, i);
    if (separation < largest) continue;
    largest = separation;
    best = i;
  }
  if (best == 0) return std::nullopt;
  FocalStep step;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    (i < best ? step.image_ids_before : step.image_ids_after).insert(sorted[i].image_id);
  }
  const Level low = LevelOf(sorted, 0, best), high = LevelOf(sorted, best, sorted.size());
  double before = low.mean, after = high.mean;
  if (step.image_ids_after.count(values.front().image_id) > 0) {
    std::swap(step.image_ids_before, step.image_ids_after);
    std::swap(before, after);
  }
  const auto is_after = [&](const ImageIntrinsics& value) {
    return step.image_ids_after.count(value.image_id) > 0;
  };
  const auto first = std::find_if(values.begin(), values.end(), is_after);
  if (std::all_of(first, values.end(), is_after)) return std::nullopt;
  const ModelImage& image = *model.FindImage(first->image_id);
  const double focal_px = MeanFocalLength(model.cameras.at(image.camera_id));
  step.first_image_after = image.name;
  step.camera_id = image.camera_id;
  step.before_px = focal_px * std::exp(before);
  step.after_px = focal_px * std::exp(after);
  step.sigmas = largest;
  return step;
}

std::optional<PrincipalPointWander> FindWander(const Model& model,
                                               const std::vector<ImageIntrinsics>& values) {
  constexpr double kMinSpread = 4e-3, kMinRatio = 4.0, kMinShare = 0.5;
  constexpr std::size_t kMinImages = 8;
  if (values.size() < kMinImages) return std::nullopt;
  std::vector<double> shares;
  for (const ImageIntrinsics& value : values) shares.push_back(value.explained_share);
  if (Median(std::move(shares)) < kMinShare) return std::nullopt;
  const Camera& camera = model.cameras.at(model.FindImage(values.front().image_id)->camera_id);
  const double least_px = kMinSpread * LargerSide(camera);
  std::optional<PrincipalPointWander> wander;
  for (const int axis : {0, 1}) {
    std::vector<double> offsets, sigmas;
    for (const ImageIntrinsics& value : values) {
      offsets.push_back(value.offset_px[axis]);
      sigmas.push_back(value.offset_sigma_px[axis]);
    }
    const double spread_px = RobustSigma(offsets);
    if (spread_px < least_px || spread_px < kMinRatio * Median(std::move(sigmas))) continue;
    if (wander && wander->spread_px > spread_px) continue;
    wander = PrincipalPointWander{spread_px, MeanFocalLength(camera)};
  }
  return wander;
}

}  // namespace

std::vector<ImageIntrinsics> IntrinsicsOfImages(const Model& model) {
  const double scale_px = TypicalError(model);
  std::vector<ImageIntrinsics> result;
  for (const ModelImage& image : model.images) {
    if (const auto own = IntrinsicsOf(model, image, scale_px)) result.push_back(*own);
  }
  return result;
}

SteadinessVerdict JudgeSteadiness(const Model& model) {
  std::map<ImageId, std::string> names;
  for (const ModelImage& image : model.images) names[image.image_id] = image.name;
  // A focal length or an offset that an image does not determine is no evidence.
  constexpr double kVague = 0.05;
  std::vector<ImageIntrinsics> values = IntrinsicsOfImages(model);
  values.erase(std::remove_if(
                   values.begin(), values.end(),
                   [](const ImageIntrinsics& value) { return !(value.log_focal_sigma < kVague); }),
               values.end());
  std::sort(values.begin(), values.end(), [&](const ImageIntrinsics& a, const ImageIntrinsics& b) {
    return NaturalLess(names.at(a.image_id), names.at(b.image_id));
  });
  std::optional<FocalStep> step = FindGroups(model, values);
  if (!step) step = FindStep(model, values);
  return {std::move(step), FindWander(model, values)};
}

SteadinessVerdict WithoutDoubtfulStep(SteadinessVerdict verdict) {
  if (verdict.step && !verdict.step->IsCertain()) verdict.step.reset();
  return verdict;
}

bool FocalStep::IsCertain() const {
  constexpr double kMinChange = 0.02, kMinSigmas = 8.0;
  return sigmas >= kMinSigmas && std::abs(std::log(after_px / before_px)) >= kMinChange;
}

bool FocalStep::IsSuspicious() const {
  constexpr double kMinChange = 0.003, kMinSigmas = 3.0;
  return sigmas >= kMinSigmas && std::abs(std::log(after_px / before_px)) >= kMinChange;
}

bool FocalStep::SpoilsShape() const {
  constexpr double kMinChange = 0.03;
  return std::abs(std::log(after_px / before_px)) >= kMinChange;
}

bool PrincipalPointWander::SpoilsShape() const {
  constexpr double kMinShare = 0.01;
  return spread_px >= kMinShare * focal_px;
}

std::string DescribeStep(const FocalStep& step) {
  if (!step.IsInTime()) {
    return fmt::format(
        "{} of the pictures, {} the first of them, have a focal length of {:.0f} px, and {} have "
        "{:.0f} px: the lens was zoomed, or the pictures come from two cameras; use the pictures "
        "of one setting only",
        step.image_ids_after.size(), step.first_image_after, step.after_px,
        step.image_ids_before.size(), step.before_px);
  }
  return fmt::format(
      "the focal length changes from {:.0f} to {:.0f} px about {}: the lens was zoomed, or the "
      "pictures come from two cameras; use the pictures of one setting only",
      step.before_px, step.after_px, step.first_image_after);
}

std::string DescribeWander(const PrincipalPointWander& wander) {
  return fmt::format(
      "the principal point wanders by {:.0f} px from picture to picture, as in a stabilized clip: "
      "switch stabilization off and film again",
      wander.spread_px);
}

}  // namespace velamap
