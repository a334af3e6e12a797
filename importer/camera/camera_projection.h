// The camera models of importer/camera/camera.h for any scalar type, for automatic differentiation:
// T is the scalar type of rays, K that of camera parameters (double if they are fixed).

#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <Eigen/Core>

#include "importer/camera/camera.h"

namespace velamap {

inline bool HasOneFocalLength(CameraModel model) {
  return model == CameraModel::kSimplePinhole || model == CameraModel::kSimpleRadial ||
         model == CameraModel::kRadial;
}

// The focal lengths are the first parameters; the two of the principal point follow.
inline std::size_t NumFocalLengths(CameraModel model) { return HasOneFocalLength(model) ? 1 : 2; }

// Brown-Conrady with an optional rational denominator; n = (k1 k2 p1 p2 k3 k4 k5 k6).
template <typename T, typename K>
Eigen::Matrix<T, 2, 1> DistortBrown(const std::array<K, 8>& n, const Eigen::Matrix<T, 2, 1>& ray) {
  const T u = ray.x(), v = ray.y();
  const T r2 = u * u + v * v;
  const T radial = (K(1) + r2 * (n[0] + r2 * (n[1] + r2 * n[4]))) /
                   (K(1) + r2 * (n[5] + r2 * (n[6] + r2 * n[7])));
  return {u * radial + T(2) * n[2] * u * v + n[3] * (r2 + T(2) * u * u),
          v * radial + T(2) * n[3] * u * v + n[2] * (r2 + T(2) * v * v)};
}

template <typename T, typename K>
Eigen::Matrix<T, 2, 1> DistortFisheye(const K* k, const Eigen::Matrix<T, 2, 1>& ray) {
  using std::atan;
  using std::sqrt;
  const T squared_r = ray.squaredNorm();
  if (squared_r < T(1e-24)) return ray;
  const T r = sqrt(squared_r);
  const T theta = atan(r);
  const T t2 = theta * theta;
  const T factor = theta * (T(1) + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) / r;
  return {ray.x() * factor, ray.y() * factor};
}

// `k` are the parameters after the principal point; `ray` is (x/z, y/z) in the cam frame.
template <typename T, typename K>
Eigen::Matrix<T, 2, 1> DistortRay(CameraModel model, const K* k,
                                  const Eigen::Matrix<T, 2, 1>& ray) {
  const K o(0);
  switch (model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      return ray;
    case CameraModel::kSimpleRadial:
      return DistortBrown<T, K>({k[0], o, o, o, o, o, o, o}, ray);
    case CameraModel::kRadial:
      return DistortBrown<T, K>({k[0], k[1], o, o, o, o, o, o}, ray);
    case CameraModel::kOpenCV:
      return DistortBrown<T, K>({k[0], k[1], k[2], k[3], o, o, o, o}, ray);
    case CameraModel::kFullOpenCV:
      return DistortBrown<T, K>({k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]}, ray);
    case CameraModel::kOpenCVFisheye:
      return DistortFisheye<T, K>(k, ray);
  }
  throw std::logic_error("unknown camera model");
}

// Returns the image position (px). `params` are all parameters of the camera in COLMAP's order.
template <typename T, typename K>
Eigen::Matrix<T, 2, 1> ImageFromRay(CameraModel model, const K* params,
                                    const Eigen::Matrix<T, 2, 1>& ray) {
  if (HasOneFocalLength(model)) {
    const Eigen::Matrix<T, 2, 1> distorted = DistortRay<T, K>(model, params + 3, ray);
    return {params[0] * distorted.x() + params[1], params[0] * distorted.y() + params[2]};
  }
  const Eigen::Matrix<T, 2, 1> distorted = DistortRay<T, K>(model, params + 4, ray);
  return {params[0] * distorted.x() + params[2], params[1] * distorted.y() + params[3]};
}

}  // namespace velamap
