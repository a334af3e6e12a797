#include "reconstruct/geometry/intrinsics_prior.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importer/camera/camera_projection.h"
#include "reconstruct/geometry/camera_conversion.h"

namespace velamap {
namespace {

// The ray at which the radial distortion is judged, as a fraction of the longest ray in the image.
constexpr double kJudgedField = 0.7;
constexpr double kClearly = 1.0 / 3.0;  // the ratio below which a sigma is clearly smaller

int BeginOfDistortion(CameraModel model) { return static_cast<int>(NumFocalLengths(model)) + 2; }

// The power of the ray length (for a fisheye, of the angle) by which a radial parameter scales; 0
// for a tangential one. `parameter` is the index among the distortion parameters.
int PowerOfRay(CameraModel model, int parameter) {
  if (model == CameraModel::kOpenCVFisheye) return 2 * (parameter + 1);
  constexpr int kPowers[] = {2, 4, 0, 0, 6, 2, 4, 6};  // k1 k2 p1 p2 k3 k4 k5 k6
  return kPowers[parameter];
}

// How far a parameter value of 1 moves the image of a ray, as a fraction of its distance from the
// optical axis. `ray_length` is the distance from the axis at depth 1.
double RelativeMovement(CameraModel model, int parameter, double ray_length) {
  const int power = PowerOfRay(model, parameter);
  if (power == 0) return 3.0 * ray_length;
  return std::pow(model == CameraModel::kOpenCVFisheye ? std::atan(ray_length) : ray_length, power);
}

// The derivatives of the relative radial movement of the judged ray by the free parameters.
Eigen::VectorXd RadialGradient(const IntrinsicsPrior& prior) {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(prior.free.size()));
  for (std::size_t i = 0; i < prior.free.size(); ++i) {
    const int distortion = prior.free[i] - BeginOfDistortion(prior.model);
    if (distortion < 0 || PowerOfRay(prior.model, distortion) == 0) continue;
    // Only the rational model has so many parameters; its denominator moves the ray inwards.
    const double sign = prior.free[i] < kBeginOfDenominator ? 1.0 : -1.0;
    gradient[static_cast<Eigen::Index>(i)] =
        sign * RelativeMovement(prior.model, distortion, kJudgedField * prior.max_ray_length);
  }
  return gradient;
}

// How far 1 sigma of the first distortion parameter moves the judged ray, as a fraction of its
// distance from the optical axis.
double RadialSigma(const IntrinsicsPrior& prior) {
  const std::size_t k1 = NumFocalLengths(prior.model) + 2;
  if (prior.sigmas.size() <= k1) return 0.0;
  return prior.sigmas[k1] * RelativeMovement(prior.model, 0, kJudgedField * prior.max_ray_length);
}

// The free parameters minus the prior's mean.
Eigen::VectorXd Change(const IntrinsicsPrior& prior, const Camera& refined) {
  Eigen::VectorXd change(static_cast<Eigen::Index>(prior.free.size()));
  for (std::size_t i = 0; i < prior.free.size(); ++i) {
    const auto parameter = static_cast<std::size_t>(prior.free[i]);
    change[static_cast<Eigen::Index>(i)] = refined.params[parameter] - prior.mean[parameter];
  }
  return change;
}

// Compares the sigma of the estimate with the larger of the prior's sigma and the change.
bool IsClearlySmaller(double sigma, double prior_sigma, double change) {
  return sigma <= kClearly * std::max(prior_sigma, std::abs(change));
}

bool ChangesPixelShape(const IntrinsicsPrior& prior, const Camera& refined) {
  if (HasOneFocalLength(prior.model)) return false;
  const double x = refined.params[0] / prior.mean[0], y = refined.params[1] / prior.mean[1];
  return std::abs(x - y) > kClearly * prior.sigmas[0] / prior.mean[0];
}

bool IsUnspecified(const Camera& calibration, int index) {
  return calibration.model == CameraModel::kFullOpenCV && index >= 4 &&
         calibration.params[static_cast<std::size_t>(index)] == 0.0;
}

}  // namespace

IntrinsicsPrior MakeIntrinsicsPrior(const Camera& calibration, const FreeIntrinsics& free,
                                    double sigma) {
  const auto num_focal = static_cast<int>(NumFocalLengths(calibration.model));
  const double focal_px = MeanFocalLength(calibration);
  IntrinsicsPrior prior;
  prior.model = calibration.model;
  prior.max_ray_length = MaxRayLength(calibration);
  prior.mean = calibration.params;
  for (int i = 0; i < static_cast<int>(calibration.params.size()); ++i) {
    const int distortion = i - BeginOfDistortion(calibration.model);
    prior.sigmas.push_back(distortion < 0 ? sigma * focal_px
                                          : sigma / RelativeMovement(calibration.model, distortion,
                                                                     prior.max_ray_length));
    const bool is_free = i < num_focal    ? free.focal_length
                         : distortion < 0 ? free.principal_point
                                          : free.distortion && !IsUnspecified(calibration, i);
    (is_free ? prior.free : prior.held).push_back(i);
  }
  return prior;
}

IntrinsicsPrior UnknownCameraPrior(const Camera& camera) {
  constexpr double kFocalSigma = 1.0, kCenterSigma = 0.02;
  constexpr double kRadialSigma = 0.3, kTangentialSigma = 0.01;
  const auto num_focal = static_cast<int>(NumFocalLengths(camera.model));
  const double focal_px = MeanFocalLength(camera);
  Camera central = camera;
  std::fill(central.params.begin() + num_focal, central.params.end(), 0.0);
  std::fill_n(central.params.begin(), num_focal, focal_px);
  central.params[static_cast<std::size_t>(num_focal)] = 0.5 * camera.width_px;
  central.params[static_cast<std::size_t>(num_focal) + 1] = 0.5 * camera.height_px;
  IntrinsicsPrior prior = MakeIntrinsicsPrior(central, {true, true, true}, kRadialSigma);
  // MakeIntrinsicsPrior() holds the zero coefficients of FULL_OPENCV. Here all are free except the
  // denominator.
  const std::size_t num_free =
      std::min(prior.sigmas.size(), static_cast<std::size_t>(kBeginOfDenominator));
  prior.free.resize(num_free);
  prior.held.resize(prior.sigmas.size() - num_free);
  std::iota(prior.free.begin(), prior.free.end(), 0);
  std::iota(prior.held.begin(), prior.held.end(), kBeginOfDenominator);
  for (int i = 0; i < static_cast<int>(prior.sigmas.size()); ++i) {
    const int distortion = i - BeginOfDistortion(camera.model);
    double& sigma = prior.sigmas[static_cast<std::size_t>(i)];
    if (i < num_focal) {
      sigma = kFocalSigma * focal_px;
    } else if (distortion < 0) {
      sigma = kCenterSigma * LargerSide(camera);
    } else if (PowerOfRay(camera.model, distortion) == 0) {
      sigma *= kTangentialSigma / kRadialSigma;
    }
  }
  return prior;
}

bool HasUnspecifiedDistortion(const Camera& calibration) {
  for (int i = 0; i < static_cast<int>(calibration.params.size()); ++i) {
    if (IsUnspecified(calibration, i)) return true;
  }
  return false;
}

Camera WithDistortionParams(const Camera& camera) {
  Camera result = camera;
  if (camera.model == CameraModel::kPinhole) result.model = CameraModel::kOpenCV;
  if (camera.model == CameraModel::kSimplePinhole) result.model = CameraModel::kSimpleRadial;
  result.params.resize(static_cast<std::size_t>(NumCameraParams(result.model)), 0.0);
  return result;
}

FreeIntrinsics DeterminedIntrinsics(const FreeIntrinsics& free, const IntrinsicsPrior& prior,
                                    const Camera& refined, const Eigen::MatrixXd& covariance) {
  if (ChangesPixelShape(prior, refined)) return {};
  const Eigen::VectorXd change = Change(prior, refined);
  // For the free parameters with an index in [begin, end).
  const auto is_determined = [&](int begin, int end) {
    double largest_change = 0.0, largest_sigma = 0.0;
    for (std::size_t i = 0; i < prior.free.size(); ++i) {
      if (prior.free[i] < begin || prior.free[i] >= end) continue;
      const auto row = static_cast<Eigen::Index>(i);
      const double prior_sigma = prior.sigmas[static_cast<std::size_t>(prior.free[i])];
      largest_change = std::max(largest_change, std::abs(change[row]) / prior_sigma);
      largest_sigma = std::max(largest_sigma, std::sqrt(covariance(row, row)) / prior_sigma);
    }
    return IsClearlySmaller(largest_sigma, 1.0, largest_change);
  };
  const auto num_focal = static_cast<int>(NumFocalLengths(prior.model));
  FreeIntrinsics determined = free;
  determined.focal_length = free.focal_length && is_determined(0, num_focal);
  determined.principal_point = free.principal_point && is_determined(num_focal, num_focal + 2);
  if (free.distortion) {
    const Eigen::VectorXd gradient = RadialGradient(prior);
    determined.distortion = IsClearlySmaller(std::sqrt(gradient.dot(covariance * gradient)),
                                             RadialSigma(prior), gradient.dot(change));
  }
  return determined;
}

bool IsWithin(const IntrinsicsPrior& prior, const Camera& camera) {
  const Eigen::VectorXd change = Change(prior, camera);
  bool is_within = std::abs(RadialGradient(prior).dot(change)) <= RadialSigma(prior);
  for (std::size_t i = 0; i < prior.free.size(); ++i) {
    if (prior.free[i] >= BeginOfDistortion(prior.model)) break;
    is_within = is_within && std::abs(change[static_cast<Eigen::Index>(i)]) <=
                                 prior.sigmas[static_cast<std::size_t>(prior.free[i])];
  }
  return is_within;
}

std::string DescribeRefinement(const Camera& calibration, const Camera& refined) {
  const std::size_t num_focal = NumFocalLengths(refined.model);
  const std::vector<double>& from = calibration.params;
  const std::vector<double>& to = refined.params;
  const auto center = static_cast<std::ptrdiff_t>(num_focal);
  const auto has_changed = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return !std::equal(from.begin() + begin, from.begin() + end, to.begin() + begin);
  };
  std::vector<std::string> changes;
  if (has_changed(0, center)) {
    changes.push_back(fmt::format("focal length {:.1f} -> {:.1f} px", MeanFocalLength(calibration),
                                  MeanFocalLength(refined)));
  }
  if (has_changed(center, center + 2)) {
    changes.push_back(fmt::format("principal point ({:.1f}, {:.1f}) -> ({:.1f}, {:.1f}) px",
                                  from[num_focal], from[num_focal + 1], to[num_focal],
                                  to[num_focal + 1]));
  }
  if (has_changed(center + 2, static_cast<std::ptrdiff_t>(to.size()))) {
    changes.push_back(fmt::format("distortion {:.4g} -> {:.4g}",
                                  fmt::join(from.begin() + center + 2, from.end(), " "),
                                  fmt::join(to.begin() + center + 2, to.end(), " ")));
  }
  return fmt::format("{}", fmt::join(changes, ", "));
}

}  // namespace velamap
