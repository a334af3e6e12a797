#include "tests/support/synthetic_scene.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "importer/geometry/look_at.h"
#include "importer/geometry/units.h"
#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

Camera DefaultCamera() {
  return {CameraModel::kOpenCV, 1920, 1080, {1200, 1202, 957.3, 541.8, -0.11, 0.03, 4e-4, -3e-4}};
}

struct PlacedMarker {
  int marker_id;
  Rigid3 world_from_marker;
};

// The marker frame on a surface with the given normal, its y axis as far up as it goes.
Eigen::Quaterniond MarkerRotation(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d z = normal.normalized();
  const Eigen::Vector3d up =
      std::abs(z.z()) > 0.95 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d x = up.cross(z).normalized();
  Eigen::Matrix3d world_from_marker;
  world_from_marker.col(0) = x;
  world_from_marker.col(1) = z.cross(x);
  world_from_marker.col(2) = z;
  return Eigen::Quaterniond(world_from_marker).normalized();
}

// Sheets lie around the plane y = 0 and face -y. The sail has 12 % camber and 15 degrees of twist.
std::vector<PlacedMarker> PlaceOnSheet(const SyntheticSceneOptions& options) {
  const double width = options.spacing_m * (options.num_columns - 1);
  const double height = options.spacing_m * (options.num_rows - 1);
  const auto surface = [&](double x, double z) -> Eigen::Vector3d {
    if (options.kind == SceneKind::kPlane) return {x, 0, z};
    const double s = x / std::max(width, 1e-9);
    const double camber = 0.12 * width * (1 - 4 * s * s);
    const double twist = 15 * kPi / 180 * (z / std::max(height, 1e-9));
    return {x * std::cos(twist) - camber * std::sin(twist),
            x * std::sin(twist) + camber * std::cos(twist), z};
  };
  std::vector<PlacedMarker> markers;
  for (int row = 0; row < options.num_rows; ++row) {
    for (int column = 0; column < options.num_columns; ++column) {
      const double x = column * options.spacing_m - width / 2;
      const double z = row * options.spacing_m - height / 2;
      constexpr double kStep = 1e-4;
      const Eigen::Vector3d along_x = surface(x + kStep, z) - surface(x - kStep, z);
      const Eigen::Vector3d along_z = surface(x, z + kStep) - surface(x, z - kStep);
      markers.push_back({row * options.num_columns + column,
                         {MarkerRotation(along_x.cross(along_z)), surface(x, z)}});
    }
  }
  return markers;
}

std::vector<PlacedMarker> PlaceOnCube(const SyntheticSceneOptions& options) {
  const std::array<Eigen::Vector3d, 6> normals = {
      -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
      -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ()};
  const double half = 0.5 * options.spacing_m * std::max(options.num_rows, options.num_columns);
  std::vector<PlacedMarker> markers;
  for (const Eigen::Vector3d& normal : normals) {
    const Eigen::Quaterniond rotation = MarkerRotation(normal);
    for (int row = 0; row < options.num_rows; ++row) {
      for (int column = 0; column < options.num_columns; ++column) {
        const Eigen::Vector3d in_face(
            (column - 0.5 * (options.num_columns - 1)) * options.spacing_m,
            (row - 0.5 * (options.num_rows - 1)) * options.spacing_m, half);
        markers.push_back({static_cast<int>(markers.size()), {rotation, rotation * in_face}});
      }
    }
  }
  return markers;
}

Layout MakeSceneLayout(const SyntheticSceneOptions& options) {
  Layout layout;
  layout.dictionary = "DICT_5X5_1000";
  layout.marker_length_m = options.marker_length_m;
  const int per_group = options.num_rows * options.num_columns;
  const int num_parts = options.kind == SceneKind::kCube ? 6 : 1;
  for (int part_idx = 0; part_idx < num_parts; ++part_idx) {
    LayoutPart part;
    part.name = options.kind == SceneKind::kCube   ? "face" + std::to_string(part_idx)
                : options.kind == SceneKind::kSail ? "sail"
                                                   : "board";
    for (int row = 0; row < options.num_rows; ++row) {
      MarkerLine line{"h" + std::to_string(row + 1), {}};
      for (int column = 0; column < options.num_columns; ++column) {
        line.marker_ids.push_back(part_idx * per_group + row * options.num_columns + column);
      }
      part.horizontal.push_back(line);
    }
    layout.parts.push_back(part);
  }
  return layout;
}

std::vector<Rigid3> PlaceCameras(const SyntheticSceneOptions& options, std::mt19937* generator) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double extent = options.spacing_m * std::max(options.num_rows, options.num_columns);
  std::vector<Rigid3> cam_from_world;
  for (int i = 0; i < options.num_frames; ++i) {
    const double t = options.num_frames > 1 ? 2.0 * i / (options.num_frames - 1) - 1 : 0.0;
    const Eigen::Vector3d wobble(unit(*generator), unit(*generator), unit(*generator));
    Eigen::Vector3d position, target = Eigen::Vector3d::Zero();
    if (options.kind == SceneKind::kCube) {
      // One turn around while rising, so that top and bottom are seen too.
      const double angle = kPi * t;
      position =
          3 * extent * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.9 * std::sin(2.5 * t));
    } else {
      position = extent * Eigen::Vector3d(0.9 * t, -1.7, 0.3 * std::sin(3 * t));
      target = 0.05 * extent * wobble.reverse();
    }
    const Eigen::Vector3d moved = position + 0.05 * extent * wobble;
    const bool looks_along_z = std::abs((target - moved).normalized().z()) > 0.95;
    const Eigen::Vector3d up = looks_along_z ? Eigen::Vector3d(0, -1, 0) : Eigen::Vector3d::UnitZ();
    cam_from_world.push_back(LookAt(moved, target, 0.1 * wobble.x(), up));
  }
  return cam_from_world;
}

std::optional<MarkerDetection> Observe(
    const Camera& camera, const Rigid3& cam_from_world, int marker_id,
    const std::array<Eigen::Vector3d, kNumCorners + 1>& x_in_world) {
  constexpr double kMaxAngleDeg = 75;
  const Eigen::Vector3d center = cam_from_world * x_in_world[0];
  const Eigen::Vector3d right = cam_from_world.rotation * (x_in_world[2] - x_in_world[1]);
  const Eigen::Vector3d up = cam_from_world.rotation * (x_in_world[1] - x_in_world[4]);
  const double cosine = -right.cross(up).normalized().dot(center.normalized());
  if (center.z() <= 0 || cosine < std::cos(kMaxAngleDeg * kPi / 180)) return std::nullopt;
  MarkerDetection detection;
  detection.marker_id = marker_id;
  for (std::size_t corner = 0; corner < kNumCorners; ++corner) {
    const auto x = ImageFromCam(camera, cam_from_world * x_in_world[corner + 1]);
    constexpr double kMargin = 5;
    if (!x || x->x() < kMargin || x->y() < kMargin || x->x() > camera.width_px - kMargin ||
        x->y() > camera.height_px - kMargin) {
      return std::nullopt;
    }
    detection.corners_in_image_px[corner] = *x;
    detection.colors[corner] = {static_cast<std::uint8_t>(100 + marker_id % 50), 110, 120};
  }
  return detection;
}

}  // namespace

SyntheticScene MakeSyntheticScene(const SyntheticSceneOptions& options) {
  std::mt19937 generator(options.seed);
  SyntheticScene scene;
  scene.camera = options.camera.width_px > 0 ? options.camera : DefaultCamera();
  scene.layout = MakeSceneLayout(options);
  const auto markers =
      options.kind == SceneKind::kCube ? PlaceOnCube(options) : PlaceOnSheet(options);
  const auto corners_in_marker = CornersInMarker(options.marker_length_m);
  for (const PlacedMarker& marker : markers) {
    auto& points = scene.x_in_world[marker.marker_id];
    points[0] = marker.world_from_marker.translation;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      points[i + 1] = marker.world_from_marker * corners_in_marker[i];
    }
  }
  scene.cam_from_world = PlaceCameras(options, &generator);
  for (int i = 0; i < options.num_frames; ++i) {
    FrameDetections frame;
    frame.image_name = fmt::format("frame_{:06}.jpg", i);
    if (options.video) {
      frame.frame_number = i;
      frame.time_s = i / 30.0;
    }
    for (const auto& [marker_id, points] : scene.x_in_world) {
      const auto detection = Observe(
          scene.camera, scene.cam_from_world[static_cast<std::size_t>(i)], marker_id, points);
      if (detection) frame.markers.push_back(*detection);
    }
    scene.frames.push_back(std::move(frame));
  }
  return scene;
}

void AddNoise(const SyntheticNoiseOptions& options, SyntheticScene* scene) {
  std::mt19937 generator(options.seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (FrameDetections& frame : scene->frames) {
    std::vector<MarkerDetection> kept;
    for (MarkerDetection marker : frame.markers) {
      if (unit(generator) < options.missing_rate) continue;
      const bool is_outlier = unit(generator) < options.outlier_rate;
      const double angle = 2 * kPi * unit(generator);
      const double shift_px = is_outlier ? options.outlier_px : 0.0;
      const Eigen::Vector2d shift = shift_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const auto draw = [&] { return Eigen::Vector2d(normal(generator), normal(generator)); };
      const double common_share = options.corner_correlation;
      // Drawn only where it is used: the other errors of a seed stay what they were.
      const Eigen::Vector2d common = common_share > 0
                                         ? Eigen::Vector2d(std::sqrt(common_share) * draw())
                                         : Eigen::Vector2d::Zero();
      for (Eigen::Vector2d& corner : marker.corners_in_image_px) {
        corner +=
            shift + options.corner_sigma_px * (common + std::sqrt(1.0 - common_share) * draw());
      }
      kept.push_back(marker);
    }
    frame.markers = std::move(kept);
  }
}

void ZoomFrom(std::size_t first_frame_idx, double zoom, SyntheticScene* scene) {
  ZoomWhere([=](std::size_t frame_idx) { return frame_idx >= first_frame_idx; }, zoom, scene);
}

void ZoomWhere(const std::function<bool(std::size_t frame_idx)>& is_zoomed, double zoom,
               SyntheticScene* scene) {
  const Eigen::Vector2d middle_px(0.5 * scene->camera.width_px, 0.5 * scene->camera.height_px);
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    if (!is_zoomed(i)) continue;
    for (MarkerDetection& marker : scene->frames[i].markers) {
      for (Eigen::Vector2d& corner_px : marker.corners_in_image_px) {
        corner_px = middle_px + zoom * (corner_px - middle_px);
      }
    }
  }
}

}  // namespace velamap
