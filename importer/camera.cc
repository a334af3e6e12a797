#include "importer/camera.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "importer/error.h"

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

bool HasOneFocalLength(CameraModel model) {
  return model == CameraModel::kSimplePinhole || model == CameraModel::kSimpleRadial ||
         model == CameraModel::kRadial;
}

// Affine part of the model: image = focal * distorted + principal point.
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

// Brown-Conrady with an optional rational denominator; n = (k1 k2 p1 p2 k3 k4 k5 k6).
Eigen::Vector2d DistortBrown(const std::array<double, 8>& n, const Eigen::Vector2d& ray) {
  const double u = ray.x(), v = ray.y();
  const double r2 = u * u + v * v;
  const double radial = (1 + r2 * (n[0] + r2 * (n[1] + r2 * n[4]))) /
                        (1 + r2 * (n[5] + r2 * (n[6] + r2 * n[7])));
  return {u * radial + 2 * n[2] * u * v + n[3] * (r2 + 2 * u * u),
          v * radial + 2 * n[3] * u * v + n[2] * (r2 + 2 * v * v)};
}

Eigen::Vector2d DistortFisheye(const double* k, const Eigen::Vector2d& ray) {
  const double r = ray.norm();
  if (r < 1e-12) return ray;
  const double theta = std::atan(r);
  const double t2 = theta * theta;
  return ray * (theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) / r);
}

Eigen::Vector2d Distort(CameraModel model, const double* k, const Eigen::Vector2d& ray) {
  switch (model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      return ray;
    case CameraModel::kSimpleRadial:
      return DistortBrown({k[0], 0, 0, 0, 0, 0, 0, 0}, ray);
    case CameraModel::kRadial:
      return DistortBrown({k[0], k[1], 0, 0, 0, 0, 0, 0}, ray);
    case CameraModel::kOpenCV:
      return DistortBrown({k[0], k[1], k[2], k[3], 0, 0, 0, 0}, ray);
    case CameraModel::kFullOpenCV:
      return DistortBrown({k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]}, ray);
    case CameraModel::kOpenCVFisheye:
      return DistortFisheye(k, ray);
  }
  throw std::logic_error("unknown camera model");
}

Eigen::Matrix2d DistortionJacobian(CameraModel model, const double* k,
                                   const Eigen::Vector2d& ray) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix2d jacobian;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
    jacobian.col(axis) =
        (Distort(model, k, ray + step) - Distort(model, k, ray - step)) / (2 * kStep);
  }
  return jacobian;
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

double MeanFocalLength(const Camera& camera) { return GetIntrinsics(camera).focal_px.mean(); }

std::optional<Eigen::Vector2d> ImageFromCam(const Camera& camera, const Eigen::Vector3d& x_in_cam) {
  if (!(x_in_cam.z() > 0)) return std::nullopt;
  const Intrinsics intrinsics = GetIntrinsics(camera);
  const Eigen::Vector2d distorted =
      Distort(camera.model, intrinsics.distortion, x_in_cam.hnormalized());
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
    const Eigen::Vector2d error = Distort(camera.model, intrinsics.distortion, ray) - distorted;
    if (error.norm() < kTolerance) return ray;
    const Eigen::Matrix2d jacobian =
        DistortionJacobian(camera.model, intrinsics.distortion, ray);
    // Beyond the turning point of the distortion the map folds over and has no honest inverse.
    if (!(jacobian.determinant() > 1e-6)) return std::nullopt;
    ray -= jacobian.inverse() * error;
  }
  return std::nullopt;
}

}  // namespace velamap
