// Whole global registrations of synthetic scenes, and how far they are from the truth.

#pragma once

#include <cmath>
#include <map>
#include <vector>

#include "importer/geometry/alignment.h"
#include "reconstruct/register_frames.h"
#include "tests/reconstruct/map/scene_map.h"

namespace velamap {

inline Registration Register(const SyntheticScene& scene, RegistrationOptions options = {}) {
  options.method = RegistrationMethod::kGlobal;
  return RegisterFrames(DatabaseImages(scene), SceneCameras(scene), scene.layout, options);
}

// RMS distance of all points from the truth after the best rigid motion, m.
inline double RmsError(const Registration& registration, const SyntheticScene& scene) {
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const auto& [marker_id, points] : registration.shape) {
    estimated.insert(estimated.end(), points.begin(), points.end());
    const auto& true_points = scene.x_in_world.at(marker_id);
    truth.insert(truth.end(), true_points.begin(), true_points.end());
  }
  const Rigid3 world_from_shape = EstimateRigid3(estimated, truth);
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (world_from_shape * estimated[i] - truth[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

// Of the markers that at least 30 % of the frames see, the fraction that the shape holds.
inline double ReconstructionRatio(const Registration& registration, const SyntheticScene& scene) {
  std::map<int, int> num_frames_of;
  for (const FrameDetections& frame : scene.frames) {
    for (const MarkerDetection& marker : frame.markers) ++num_frames_of[marker.marker_id];
  }
  int num_visible = 0, num_reconstructed = 0;
  for (const auto& [marker_id, num_frames] : num_frames_of) {
    if (num_frames < 0.3 * static_cast<double>(scene.frames.size())) continue;
    ++num_visible;
    num_reconstructed += static_cast<int>(registration.shape.count(marker_id));
  }
  return static_cast<double>(num_reconstructed) / num_visible;
}

inline SyntheticScene SceneWithNoise(SceneKind kind, std::uint32_t seed) {
  SyntheticScene scene = MakeScene(kind, 30, kind == SceneKind::kSail);
  AddNoise({0.2, 0.0, 0.0, 0, seed}, &scene);
  return scene;
}

}  // namespace velamap
