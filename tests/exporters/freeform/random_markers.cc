#include "tests/exporters/freeform/random_markers.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The distance from z = height(x, y) along its gradient, exact in the first order.
TrueSurface Graph(std::function<double(double, double)> height, double half_length_m) {
  TrueSurface surface;
  surface.distance_m = [height](const Eigen::Vector3d& x) {
    constexpr double kStep = 1e-5;
    const double z_x = (height(x.x() + kStep, x.y()) - height(x.x() - kStep, x.y())) / (2 * kStep);
    const double z_y = (height(x.x(), x.y() + kStep) - height(x.x(), x.y() - kStep)) / (2 * kStep);
    return (x.z() - height(x.x(), x.y())) / std::sqrt(1 + z_x * z_x + z_y * z_y);
  };
  surface.point = [height, half_length_m](double u, double v) {
    const double x = (2 * u - 1) * half_length_m, y = (2 * v - 1) * half_length_m;
    return Eigen::Vector3d(x, y, height(x, y));
  };
  return surface;
}

Eigen::Vector3d OnSurface(const TrueSurface& surface, Eigen::Vector3d x_m) {
  for (int step = 0; step < 5; ++step) x_m -= surface.distance_m(x_m) * TrueNormal(surface, x_m);
  return x_m;
}

FreeformMarker MakeMarker(const TrueSurface& surface, const Eigen::Vector3d& center_m,
                          const RandomMarkers& random, std::mt19937* generator) {
  std::uniform_real_distribution<double> angle(0, 2 * kPi);
  std::normal_distribution<double> noise_m(0, random.sigma_m);
  const Eigen::Vector3d normal = TrueNormal(surface, center_m);
  const Eigen::Vector3d right =
      Eigen::AngleAxisd(angle(*generator), normal) * normal.unitOrthogonal();
  const Eigen::Vector3d up = normal.cross(right);
  constexpr double kCorners[][2] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
  FreeformMarker marker;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const double half_m = random.side_m / 2;
    marker.corners_in_shape_m[i] =
        OnSurface(surface, center_m + half_m * (kCorners[i][0] * right + kCorners[i][1] * up));
    for (double& x : marker.corners_in_shape_m[i]) {
      if (random.sigma_m > 0) x += noise_m(*generator);
    }
    marker.sigmas_m[i] = random.sigma_m;
  }
  const auto& x = marker.corners_in_shape_m;
  marker.normal = (x[1] - x[3]).cross(x[0] - x[2]).normalized();
  return marker;
}

}  // namespace

TrueSurface Sphere(double radius_m) {
  return {[=](const Eigen::Vector3d& x) { return x.norm() - radius_m; },
          [=](double u, double v) {
            const double z = 2 * v - 1, r = std::sqrt(1 - z * z);
            return Eigen::Vector3d(radius_m * Eigen::Vector3d(r * std::cos(2 * kPi * u),
                                                              r * std::sin(2 * kPi * u), z));
          }};
}

TrueSurface Cylinder(double radius_m, double length_m) {
  return {[=](const Eigen::Vector3d& x) { return x.head<2>().norm() - radius_m; },
          [=](double u, double v) {
            return Eigen::Vector3d(radius_m * std::cos(2 * kPi * u),
                                   radius_m * std::sin(2 * kPi * u), (v - 0.5) * length_m);
          }};
}

TrueSurface Torus(double radius_m, double tube_radius_m) {
  return {[=](const Eigen::Vector3d& x) {
            return std::hypot(x.head<2>().norm() - radius_m, x.z()) - tube_radius_m;
          },
          [=](double u, double v) {
            const double r = radius_m + tube_radius_m * std::cos(2 * kPi * v);
            return Eigen::Vector3d(r * std::cos(2 * kPi * u), r * std::sin(2 * kPi * u),
                                   tube_radius_m * std::sin(2 * kPi * v));
          }};
}

TrueSurface Saddle(double bend_per_m, double half_length_m) {
  return Graph([=](double x, double y) { return bend_per_m * (x * x - y * y); }, half_length_m);
}

TrueSurface Wave(double height_m, double half_length_m) {
  return Graph(
      [=](double x, double y) { return height_m * std::sin(2 * kPi * x) * std::cos(3 * y); },
      half_length_m);
}

Eigen::Vector3d TrueNormal(const TrueSurface& surface, const Eigen::Vector3d& x_m) {
  constexpr double kStep = 1e-6;
  Eigen::Vector3d normal;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
    normal[axis] = surface.distance_m(x_m + step) - surface.distance_m(x_m - step);
  }
  return normal.normalized();
}

std::vector<FreeformMarker> DrawMarkers(const TrueSurface& surface, const RandomMarkers& random,
                                        std::mt19937* generator) {
  constexpr int kNumTries = 5000;
  std::uniform_real_distribution<double> uniform;
  std::vector<Eigen::Vector3d> centers_m;
  std::vector<FreeformMarker> markers;
  for (int i = 0; i < kNumTries; ++i) {
    const double u = uniform(*generator), v = uniform(*generator);
    const Eigen::Vector3d center_m = surface.point(u, v);
    if (std::any_of(centers_m.begin(), centers_m.end(), [&](const Eigen::Vector3d& other) {
          return (other - center_m).norm() < random.spacing_m;
        })) {
      continue;
    }
    centers_m.push_back(center_m);
    markers.push_back(MakeMarker(surface, center_m, random, generator));
    markers.back().marker_id = static_cast<int>(markers.size()) - 1;
  }
  return markers;
}

}  // namespace velamap
