// Shared by the tests of registration: a synthetic scene as the database would hold it.

#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "importer/database/colmap_database.h"
#include "reconstruct/geometry/frame_shape.h"
#include "reconstruct/registration/registration.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {

constexpr CameraId kSceneCameraId = 1;

inline SyntheticScene MakeScene(SceneKind kind, int num_frames, bool video) {
  SyntheticSceneOptions options;
  options.kind = kind;
  options.num_frames = num_frames;
  options.video = video;
  if (kind == SceneKind::kCube) options.num_rows = options.num_columns = 3;
  return MakeSyntheticScene(options);
}

inline std::vector<DatabaseImage> DatabaseImages(const SyntheticScene& scene) {
  std::vector<DatabaseImage> images;
  for (const FrameDetections& frame : scene.frames) {
    images.push_back({static_cast<ImageId>(images.size() + 1), kSceneCameraId, frame});
  }
  return images;
}

inline std::map<CameraId, Camera> SceneCameras(const SyntheticScene& scene) {
  return {{kSceneCameraId, scene.camera}};
}

inline std::vector<FrameShape> FrameShapes(const SyntheticScene& scene) {
  std::vector<FrameShape> frames;
  for (const DatabaseImage& image : DatabaseImages(scene)) {
    frames.push_back(EstimateFrameShape(image, scene.camera, scene.layout));
  }
  return frames;
}

// Truth in the cam frame of one frame.
inline MarkerPoints TruthInCam(const SyntheticScene& scene, int marker_id, int frame_idx) {
  return Transform(scene.cam_from_world[static_cast<std::size_t>(frame_idx)],
                   scene.x_in_world.at(marker_id));
}

// The index of the image whose camera is the frame of the shape.
inline int CentralIdx(const Registration& registration) {
  return static_cast<int>(registration.central_image_id) - 1;
}

// The largest distance of a marker from the truth (root mean square over its corners), m.
inline double MaxError(const Registration& registration, const SyntheticScene& scene) {
  double max_error_m = 0;
  for (const auto& [marker_id, points] : registration.shape) {
    max_error_m = std::max(
        max_error_m, RmsDistance(points, TruthInCam(scene, marker_id, CentralIdx(registration))));
  }
  return max_error_m;
}

inline Rigid3 TrueCamFromShape(const Registration& registration, const SyntheticScene& scene,
                               ImageId image_id) {
  return scene.cam_from_world[image_id - 1] *
         Inverse(scene.cam_from_world[static_cast<std::size_t>(CentralIdx(registration))]);
}

struct RegistrationCase {
  SceneKind kind;
  bool video;
};

}  // namespace velamap
