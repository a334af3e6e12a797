#include "importer/camera/camera.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "importer/base/error.h"
#include "importer/camera/camera_jacobian.h"
#include "importer/camera/camera_projection.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

struct ModelEntry {
  CameraModel model;
  const char* name;
  int num_params;
};

constexpr std::array<ModelEntry, 7> kModels = {{{CameraModel::kSimplePinhole, "SIMPLE_PINHOLE", 3},
                                                {CameraModel::kPinhole, "PINHOLE", 4},
                                                {CameraModel::kSimpleRadial, "SIMPLE_RADIAL", 4},
                                                {CameraModel::kRadial, "RADIAL", 5},
                                                {CameraModel::kOpenCV, "OPENCV", 8},
                                                {CameraModel::kOpenCVFisheye, "OPENCV_FISHEYE", 8},
                                                {CameraModel::kFullOpenCV, "FULL_OPENCV", 12}}};

const ModelEntry& Entry(CameraModel model) {
  for (const ModelEntry& entry : kModels) {
    if (entry.model == model) return entry;
  }
  throw std::logic_error("unknown camera model");
}

// The affine part of the model: image = focal * distorted + principal point.
struct Intrinsics {
  Eigen::Vector2d focal_px;
  Eigen::Vector2d principal_point_px;
  const double* distortion;
};

Intrinsics GetIntrinsics(const Camera& camera) {
  VELAMAP_CHECK(static_cast<int>(camera.params.size()) == NumCameraParams(camera.model));
  const double* p = camera.params.data();
  if (HasOneFocalLength(camera.model)) return {{p[0], p[0]}, {p[1], p[2]}, p + 3};
  return {{p[0], p[1]}, {p[2], p[3]}, p + 4};
}

// Whether the rational model has a pole between the optical axis and a ray of this length. The
// denominator shows it, whereas a pole at which numerator and denominator nearly cancel is too
// narrow to be noticed in the image.
bool IsBeyondPole(const Camera& camera, double ray_length) {
  if (camera.model != CameraModel::kFullOpenCV) return false;
  const double* k4 = GetIntrinsics(camera).distortion + 5;
  const double r2 = ray_length * ray_length;
  return !(1.0 + r2 * (k4[0] + r2 * (k4[1] + r2 * k4[2])) > 0);
}

}  // namespace

std::string CameraModelName(CameraModel model) { return Entry(model).name; }

int NumCameraParams(CameraModel model) { return Entry(model).num_params; }

std::optional<CameraModel> CameraModelFromName(const std::string& name) {
  for (const ModelEntry& entry : kModels) {
    if (name == entry.name) return entry.model;
  }
  return std::nullopt;
}

std::optional<CameraModel> CameraModelFromId(int model_id) {
  for (const ModelEntry& entry : kModels) {
    if (model_id == static_cast<int>(entry.model)) return entry.model;
  }
  return std::nullopt;
}

Camera UnknownCamera(int width_px, int height_px, double focal_px) {
  constexpr double kUsualFocal = 1.2;
  if (!(focal_px > 0)) focal_px = kUsualFocal * std::max(width_px, height_px);
  return {CameraModel::kSimpleRadial,
          width_px,
          height_px,
          {focal_px, 0.5 * width_px, 0.5 * height_px, 0.0}};
}

double MeanFocalLength(const Camera& camera) { return GetIntrinsics(camera).focal_px.mean(); }

double SmallestFocalLength(const Camera& camera) {
  return GetIntrinsics(camera).focal_px.minCoeff();
}

std::optional<Eigen::Vector2d> ImageFromCam(const Camera& camera, const Eigen::Vector3d& x_in_cam) {
  if (!(x_in_cam.z() > 0)) return std::nullopt;
  const Intrinsics intrinsics = GetIntrinsics(camera);
  const Eigen::Vector2d distorted =
      DistortRay<double, double>(camera.model, intrinsics.distortion, x_in_cam.hnormalized());
  return intrinsics.focal_px.cwiseProduct(distorted) + intrinsics.principal_point_px;
}

std::optional<Eigen::Vector2d> CamFromImage(const Camera& camera,
                                            const Eigen::Vector2d& x_in_image_px) {
  constexpr int kMaxIterations = 100;
  constexpr double kTolerance = 1e-12;
  const Intrinsics intrinsics = GetIntrinsics(camera);
  const Eigen::Vector2d distorted =
      (x_in_image_px - intrinsics.principal_point_px).cwiseQuotient(intrinsics.focal_px);
  Eigen::Vector2d ray = distorted;
  for (int i = 0; i < kMaxIterations; ++i) {
    const RayFunction found = DistortRayWithJacobian(camera.model, intrinsics.distortion, ray);
    const Eigen::Vector2d error = found.value - distorted;
    if (error.norm() < kTolerance) return ray;
    // Beyond its turning point the distortion folds over and has no unique inverse.
    if (!(found.by_ray.determinant() > 1e-6)) return std::nullopt;
    ray -= found.by_ray.inverse() * error;
  }
  return std::nullopt;
}

double MaxRayLength(const Camera& camera) {
  const Intrinsics intrinsics = GetIntrinsics(camera);
  double max_length = 0.0;
  for (const double x_px : {0.0, static_cast<double>(camera.width_px)}) {
    for (const double y_px : {0.0, static_cast<double>(camera.height_px)}) {
      const Eigen::Vector2d corner_px(x_px, y_px);
      const Eigen::Vector2d distorted =
          (corner_px - intrinsics.principal_point_px).cwiseQuotient(intrinsics.focal_px);
      max_length = std::max(max_length, CamFromImage(camera, corner_px).value_or(distorted).norm());
    }
  }
  return max_length;
}

bool HasMonotonicDistortion(const Camera& camera) {
  constexpr int kNumDirections = 64;
  constexpr double kMaxRayLength = 12.0;  // 85 degrees
  const Intrinsics intrinsics = GetIntrinsics(camera);
  // Small relative to the image, so that no fold stays hidden between two steps.
  const double step =
      0.01 * std::hypot(camera.width_px, camera.height_px) / intrinsics.focal_px.maxCoeff();
  if (!(step > 0)) return false;
  const Eigen::Array2d size_px(camera.width_px, camera.height_px);
  for (int i = 0; i < kNumDirections; ++i) {
    const double angle = 2.0 * kPi * i / kNumDirections;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    for (double length = step; length < kMaxRayLength; length += step) {
      if (IsBeyondPole(camera, length)) return false;
      const RayFunction found =
          DistortRayWithJacobian(camera.model, intrinsics.distortion, length * direction);
      const Eigen::Vector2d outwards = found.by_ray * direction;
      if (!(found.by_ray.determinant() > 0 && outwards.dot(direction) > 0)) return false;
      const Eigen::Array2d x_px =
          intrinsics.focal_px.cwiseProduct(found.value) + intrinsics.principal_point_px;
      if ((x_px < 0).any() || (x_px > size_px).any()) break;
    }
  }
  return true;
}

}  // namespace velamap
