#include "tests/reconstruct/scene_model.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tests/support/true_model.h"

namespace velamap {
namespace {

// Corners of a square with these errors of its sides and of the difference of its diagonals (m),
// and heights over its plane. Of the displacements in the plane that give the errors, to first
// order, the smallest are taken.
std::array<Eigen::Vector3d, kNumCorners> Deform(
    const std::array<Eigen::Vector3d, kNumCorners>& corners,
    const Eigen::Matrix<double, 5, 1>& errors_m, double height_m) {
  const Eigen::Vector3d x = (corners[1] - corners[0]).normalized();
  const Eigen::Vector3d y = (corners[3] - corners[0]).normalized();
  Eigen::Matrix<double, 5, 8> errors_by_corners = Eigen::Matrix<double, 5, 8>::Zero();
  const auto add_length = [&](int row, int a, int b, double sign) {
    const Eigen::Vector3d direction = (corners[b] - corners[a]).normalized();
    const Eigen::RowVector2d in_plane(direction.dot(x), direction.dot(y));
    errors_by_corners.block<1, 2>(row, 2 * a) -= sign * in_plane;
    errors_by_corners.block<1, 2>(row, 2 * b) += sign * in_plane;
  };
  for (int side = 0; side < 4; ++side) add_length(side, side, (side + 1) % 4, 1.0);
  add_length(4, 0, 2, 1.0);
  add_length(4, 1, 3, -1.0);
  const Eigen::Matrix<double, 8, 1> shifts =
      errors_by_corners.transpose() *
      (errors_by_corners * errors_by_corners.transpose()).inverse() * errors_m;
  std::array<Eigen::Vector3d, kNumCorners> deformed = corners;
  for (int c = 0; c < 4; ++c) {
    deformed[c] += shifts[2 * c] * x + shifts[2 * c + 1] * y +
                   (c % 2 == 0 ? height_m : -height_m) * x.cross(y);
  }
  return deformed;
}

}  // namespace

Model MakeSceneModel(const SyntheticScene& scene) {
  Model model = TrueModel(scene);
  RemoveShortTracks(&model, 2);
  return model;
}

SyntheticScene WithPrintErrors(const SyntheticScene& scene, double tolerance, double flatness,
                               std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  SyntheticScene printed = scene;
  for (auto& [marker_id, points] : printed.x_in_world) {
    const double length_m = MarkerLength(scene.layout, marker_id);
    Eigen::Matrix<double, 5, 1> errors_m;
    for (double& error : errors_m) error = tolerance * length_m * normal(random);
    errors_m[4] *= std::sqrt(2.0);
    const auto corners = Deform({points[1], points[2], points[3], points[4]}, errors_m,
                                flatness * length_m * normal(random));
    points[0].setZero();
    for (int c = 0; c < kNumCorners; ++c) {
      points[c + 1] = corners[c];
      points[0] += corners[c] / kNumCorners;
    }
  }
  ProjectAnew(&printed);
  return printed;
}

void ResizeMarker(int marker_id, double factor, SyntheticScene* scene) {
  auto& points = scene->x_in_world.at(marker_id);
  for (int c = 1; c <= kNumCorners; ++c) points[c] = points[0] + factor * (points[c] - points[0]);
  ProjectAnew(scene);
}

void PullCorner(int marker_id, int corner, double share, SyntheticScene* scene) {
  auto& points = scene->x_in_world.at(marker_id);
  points[corner] += share * (points[0] - points[corner]);
  ProjectAnew(scene);
}

void AddInset(const std::function<double(const MarkerDetection&)>& inset_px,
              SyntheticScene* scene) {
  for (FrameDetections& frame : scene->frames) {
    for (MarkerDetection& marker : frame.markers) {
      const double distance_px = inset_px(marker);
      const auto corners = marker.corners_in_image_px;
      for (int c = 0; c < kNumCorners; ++c) {
        marker.corners_in_image_px[c] +=
            distance_px * ((corners[(c + 1) % 4] - corners[c]).normalized() +
                           (corners[(c + 3) % 4] - corners[c]).normalized());
      }
    }
  }
}

void ProjectAnew(SyntheticScene* scene) {
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    for (MarkerDetection& marker : scene->frames[i].markers) {
      for (int c = 0; c < kNumCorners; ++c) {
        const Eigen::Vector3d& x = scene->x_in_world.at(marker.marker_id)[c + 1];
        marker.corners_in_image_px[c] =
            ImageFromCam(scene->camera, scene->cam_from_world[i] * x).value();
      }
    }
  }
}

}  // namespace velamap
