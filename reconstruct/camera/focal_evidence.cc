#include "reconstruct/camera/focal_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "importer/base/error.h"
#include "importer/base/parallel.h"
#include "importer/base/statistics.h"
#include "importer/camera/camera_jacobian.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/pose_step.h"
#include "importer/geometry/quad.h"
#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

using CornerVector = Eigen::Matrix<double, 2 * kNumCorners, 1>;

constexpr double kMinFocalOnGrid = 0.2, kMaxFocalOnGrid = 10.0;  // times the larger side
constexpr double kGridStep = 0.12;                               // of the logarithm
constexpr double kFocalLossSigmas = 3.0;

Camera LensOf(CameraModel model, int width_px, int height_px, double focal_px) {
  const double cx = 0.5 * width_px, cy = 0.5 * height_px;
  if (model == CameraModel::kOpenCVFisheye) {
    return {model, width_px, height_px, {focal_px, focal_px, cx, cy, 0, 0, 0, 0}};
  }
  VELAMAP_CHECK(model == CameraModel::kSimpleRadial);
  return {model, width_px, height_px, {focal_px, cx, cy, 0}};
}

// Errors of a square in its best pose, in sigmas, and how they change with the logarithm of the
// focal length while the pose follows.
struct ViewErrors {
  CornerVector errors = CornerVector::Zero();
  CornerVector by_log_focal = CornerVector::Zero();
};

std::optional<CornerVector> Project(const Camera& camera, const Rigid3& cam_from_marker) {
  const auto corners = CornersInMarker(1.0);
  CornerVector projected;
  for (int i = 0; i < kNumCorners; ++i) {
    const auto x_px = ImageFromCam(camera, cam_from_marker * corners[static_cast<std::size_t>(i)]);
    if (!x_px) return std::nullopt;
    projected.segment<2>(2 * i) = *x_px;
  }
  return projected;
}

// Derivatives of the projected corners with respect to the pose, whose steps are as in PlusPose().
Eigen::Matrix<double, 2 * kNumCorners, 6> ByPose(const Camera& camera, const Rigid3& pose) {
  const auto corners = CornersInMarker(1.0);
  Eigen::Matrix<double, 2 * kNumCorners, 6> jacobian;
  for (int i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector3d rotated = pose.rotation * corners[static_cast<std::size_t>(i)];
    const ImagePoint image = ImageFromPointWithJacobian(camera, rotated + pose.translation);
    jacobian.middleRows<2>(2 * i) = ByPoseStep(image.by_point, rotated);
  }
  return jacobian;
}

// Returns nothing if the camera cannot have seen the square.
std::optional<ViewErrors> ErrorsOf(const Camera& camera, const SquareView& view, bool with_change) {
  const std::vector<MarkerPose> poses = EstimateMarkerPoses(camera, view.corners_px, 1.0);
  if (poses.empty()) return std::nullopt;
  const auto projected = Project(camera, poses.front().cam_from_marker);
  if (!projected) return std::nullopt;
  ViewErrors result;
  const Eigen::Vector2d center(0.5 * camera.width_px, 0.5 * camera.height_px);
  for (int i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector2d x_px = projected->segment<2>(2 * i);
    result.errors.segment<2>(2 * i) =
        (x_px - view.corners_px[static_cast<std::size_t>(i)]) / view.sigma_px;
    result.by_log_focal.segment<2>(2 * i) = (x_px - center) / view.sigma_px;
  }
  if (!with_change) return result;
  const Eigen::Matrix<double, 2 * kNumCorners, 6> scaled =
      ByPose(camera, poses.front().cam_from_marker) / view.sigma_px;
  result.by_log_focal -= scaled * scaled.colPivHouseholderQr().solve(result.by_log_focal);
  return result;
}

// The normal equation of the logarithm of the focal length.
struct FocalEquation {
  double gradient = 0.0, information = 0.0;
  int num_views = 0;  // that took part
};

// The views at one focal length.
class PooledViews {
 public:
  PooledViews(std::vector<SquareView> views, int num_threads)
      : views_(std::move(views)), num_threads_(num_threads) {}

  std::size_t NumViews() const { return views_.size(); }

  std::vector<std::optional<ViewErrors>> Evaluate(const Camera& camera, bool with_change) const {
    std::vector<std::optional<ViewErrors>> errors(views_.size());
    ParallelFor(views_.size(), num_threads_,
                [&](std::size_t i) { errors[i] = ErrorsOf(camera, views_[i], with_change); });
    return errors;
  }

  // A view that the camera cannot have seen counts like one with a very large error.
  double Cost(const Camera& camera, double variance) const {
    constexpr double kFarOff = 1e4;
    const CauchyLoss loss{kFocalLossSigmas * kFocalLossSigmas * variance};
    double cost = 0.0;
    for (const auto& errors : Evaluate(camera, false)) {
      cost += loss.Value(errors ? errors->errors.squaredNorm() : kFarOff * variance) / variance;
    }
    return cost;
  }

  FocalEquation Equation(const Camera& camera, double variance) const {
    const CauchyLoss loss{kFocalLossSigmas * kFocalLossSigmas * variance};
    FocalEquation equation;
    for (const auto& errors : Evaluate(camera, true)) {
      if (!errors) continue;
      ++equation.num_views;
      const double weight = loss.Weight(errors->errors.squaredNorm()) / variance;
      equation.gradient += weight * errors->by_log_focal.dot(errors->errors);
      equation.information += weight * errors->by_log_focal.squaredNorm();
    }
    return equation;
  }

  // The variance of the errors relative to the views' sigmas, from the median.
  double Variance(const Camera& camera) const {
    std::vector<double> squares;
    for (const auto& errors : Evaluate(camera, false)) {
      if (errors) squares.push_back(errors->errors.squaredNorm());
    }
    constexpr double kMin = 1e-8;  // exact corners
    return squares.empty() ? 1.0 : std::max(kMin, Median(std::move(squares)) / kChiSquaredMedian2);
  }

 private:
  std::vector<SquareView> views_;
  int num_threads_;
};

std::vector<SquareView> MostInformative(std::vector<SquareView> views) {
  const auto size_in_sigmas = [](const SquareView& view) {
    return QuadMeanSide(view.corners_px) / view.sigma_px;
  };
  std::stable_sort(views.begin(), views.end(), [&](const SquareView& a, const SquareView& b) {
    return size_in_sigmas(a) > size_in_sigmas(b);
  });
  if (views.size() > kMaxFocalViews) views.resize(kMaxFocalViews);
  return views;
}

}  // namespace

FocalEvidence FindFocalLength(CameraModel model, int width_px, int height_px,
                              std::vector<SquareView> views, int num_threads) {
  constexpr int kMaxNumSteps = 10;
  const int side_px = std::max(width_px, height_px);
  const PooledViews pooled(MostInformative(std::move(views)), num_threads);
  const auto lens = [&](double log_focal) {
    return LensOf(model, width_px, height_px, std::exp(log_focal));
  };
  const double low = std::log(kMinFocalOnGrid * side_px),
               high = std::log(kMaxFocalOnGrid * side_px);
  // Costs are comparable only for the same noise. A first pass over the grid finds the smallest
  // noise, a second pass the costs.
  double variance = std::numeric_limits<double>::infinity();
  for (double x = low; x <= high; x += kGridStep) {
    variance = std::min(variance, pooled.Variance(lens(x)));
  }
  // A few views cannot show that corners are better than their sigmas.
  constexpr std::size_t kFewViews = 8;
  if (pooled.NumViews() < kFewViews) variance = std::max(variance, 1.0);
  FocalEvidence result{UnknownCamera(width_px, height_px), 0.0,
                       std::numeric_limits<double>::infinity(), 0};
  double best = low;
  for (double x = low; x <= high; x += kGridStep) {
    const double cost = pooled.Cost(lens(x), variance);
    if (cost >= result.cost) continue;
    result.cost = cost;
    best = x;
  }
  double information = 0.0;
  for (int i = 0; i < kMaxNumSteps; ++i) {
    const FocalEquation equation = pooled.Equation(lens(best), variance);
    information = equation.information;
    result.num_views = equation.num_views;
    if (!(information > 0)) break;
    const double step = std::clamp(-equation.gradient / information, -kGridStep, kGridStep);
    best = std::clamp(best + step, low, high);
    if (std::abs(step) < 1e-4) break;
  }
  result.log_sigma =
      information > 0 ? 1.0 / std::sqrt(information) : std::numeric_limits<double>::infinity();
  if (result.num_views > 0) {
    result.camera = lens(best);
    result.cost = pooled.Cost(result.camera, variance);
  }
  return result;
}

}  // namespace velamap
