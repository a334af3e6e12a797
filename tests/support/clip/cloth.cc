#include "tests/support/clip/cloth.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace velamap {
namespace {

constexpr double kFoot_m = 3.0, kLuff_m = 6.0, kHead_m = 0.05;
constexpr double kFootHeight_m = 0.8;  // above the water
constexpr double kMastBend_m = 0.06;

using Tangents = Eigen::Matrix<double, 3, 2>;  // along u and v

Tangents TangentsAt(const Surface& surface, const Eigen::Vector2d& uv) {
  constexpr double kStep = 1e-5;
  Tangents tangents;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
    tangents.col(axis) = (surface(uv + step) - surface(uv - step)) / (2 * kStep);
  }
  return tangents;
}

// The step in (u, v) that moves by the tangential part of `direction`.
Eigen::Vector2d StepInUv(const Tangents& tangents, const Eigen::Vector3d& direction) {
  return (tangents.transpose() * tangents).inverse() * (tangents.transpose() * direction);
}

// Parallel transport of a direction from one tangent plane to a neighbouring one.
Eigen::Vector3d Transport(const Tangents& from, const Tangents& to,
                          const Eigen::Vector3d& direction) {
  return Eigen::Quaterniond::FromTwoVectors(from.col(0).cross(from.col(1)),
                                            to.col(0).cross(to.col(1))) *
         direction;
}

}  // namespace

Eigen::Vector2d WalkOnSurface(const Surface& surface, const Eigen::Vector2d& uv,
                              const Eigen::Vector2d& offset_m) {
  constexpr int kNumSteps = 4;
  const double length_m = offset_m.norm();
  if (length_m == 0) return uv;
  Tangents tangents = TangentsAt(surface, uv);
  const Eigen::Vector3d right = tangents.col(0).normalized();
  const Eigen::Vector3d normal = tangents.col(0).cross(tangents.col(1));
  const Eigen::Vector3d up = normal.cross(right).normalized();
  Eigen::Vector3d direction = (offset_m.x() * right + offset_m.y() * up) / length_m;
  Eigen::Vector2d place = uv;
  const double step_m = length_m / kNumSteps;
  for (int i = 0; i < kNumSteps; ++i) {
    const Eigen::Vector2d halfway = place + StepInUv(tangents, 0.5 * step_m * direction);
    const Tangents there = TangentsAt(surface, halfway);
    const Eigen::Vector3d direction_there = Transport(tangents, there, direction);
    place += StepInUv(there, step_m * direction_there);
    tangents = TangentsAt(surface, place);
    direction = Transport(there, tangents, direction_there);
  }
  return place;
}

double SailChord(const Mainsail& shape, double v) {
  // Numeric derivatives at the border need places just outside [0, 1].
  const double left = std::max(0.0, 1.0 - v);
  return shape.scale * (kFoot_m * std::pow(left, 0.75) + kHead_m);
}

Surface MakeSail(const Mainsail& shape) {
  return [shape](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
    const double u = uv.x(), v = uv.y();
    const double depth = u * (1 - u) * (1.6 - u) / 0.288;  // 1 at u = 0.4
    const double angle = shape.twist_rad * v;
    const double chord_m = SailChord(shape, v);
    const Eigen::Vector3d along(std::cos(angle), -std::sin(angle), 0);
    const Eigen::Vector3d out(-std::sin(angle), -std::cos(angle), 0);
    const Eigen::Vector3d luff(-4 * shape.scale * kMastBend_m * v * (1 - v), 0,
                               kFootHeight_m + shape.scale * kLuff_m * v);
    return luff + chord_m * (u * along + (shape.camber + 0.02 * v) * depth * out);
  };
}

}  // namespace velamap
