// Derivatives of the camera models of camera_projection.h with respect to the ray, by automatic
// differentiation.

#pragma once

#include <ceres/jet.h>
#include <Eigen/Core>

#include "importer/camera/camera_projection.h"

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

}  // namespace velamap
