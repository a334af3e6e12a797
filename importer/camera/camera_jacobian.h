// Derivatives of the camera models of camera_projection.h with respect to a ray (x/z, y/z), by
// automatic differentiation, and with respect to a point in the cam frame.

#pragma once

#include <ceres/jet.h>
#include <Eigen/Core>

#include "importer/camera/camera.h"
#include "importer/camera/camera_projection.h"
#include "importer/geometry/pose_step.h"

namespace velamap {

// A function of a ray and its derivative there.
struct RayFunction {
  Eigen::Vector2d value;
  Eigen::Matrix2d by_ray;
};

template <typename Function>
RayFunction DifferentiateByRay(const Function& function, const Eigen::Vector2d& ray) {
  using Jet = ceres::Jet<double, 2>;
  const Eigen::Matrix<Jet, 2, 1> jets =
      function(Eigen::Matrix<Jet, 2, 1>(Jet(ray.x(), 0), Jet(ray.y(), 1)));
  RayFunction result{{jets[0].a, jets[1].a}, {}};
  result.by_ray << jets[0].v.transpose(), jets[1].v.transpose();
  return result;
}

// The distorted ray. `k` are the parameters after the principal point.
inline RayFunction DistortRayWithJacobian(CameraModel model, const double* k,
                                          const Eigen::Vector2d& ray) {
  return DifferentiateByRay(
      [&](const auto& jets) { return DistortRay<ceres::Jet<double, 2>, double>(model, k, jets); },
      ray);
}

// The image position, px. `params` are all parameters of the camera, in COLMAP's order.
inline RayFunction ImageFromRayWithJacobian(CameraModel model, const double* params,
                                            const Eigen::Vector2d& ray) {
  return DifferentiateByRay(
      [&](const auto& jets) {
        return ImageFromRay<ceres::Jet<double, 2>, double>(model, params, jets);
      },
      ray);
}

// The image position of a point in front of the camera, px, and its derivative with respect to the
// point.
struct ImagePoint {
  Eigen::Vector2d value_px;
  Eigen::Matrix<double, 2, 3> by_point;
};

inline ImagePoint ImageFromPointWithJacobian(const Camera& camera,
                                             const Eigen::Vector3d& x_in_cam) {
  const RayFunction image = ImageFromRayWithJacobian(camera.model, camera.params.data(),
                                                     Eigen::Vector2d(x_in_cam.hnormalized()));
  return {image.value, image.by_ray * RayByPoint(x_in_cam)};
}

}  // namespace velamap
