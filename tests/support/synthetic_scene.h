// A scene of markers on a known surface seen by known cameras, with exact truth. Noise has options
// of its own, so that a scene without noise is exact.

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/camera/camera.h"
#include "importer/detect/detection.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

enum class SceneKind {
  kSail,   // a curved, cambered sheet in lines, seen by a camera that sweeps past it as in a video
  kPlane,  // a flat board
  kCube,   // markers on six faces, seen from all around: no image sees more than three faces
};

struct SyntheticSceneOptions {
  SceneKind kind = SceneKind::kSail;
  int num_rows = 5;  // of markers (per face for kCube)
  int num_columns = 6;
  double marker_length_m = 0.1;
  double spacing_m = 0.25;  // between marker centres
  int num_frames = 21;
  bool video = true;  // frames carry numbers and times
  Camera camera;      // model with zero size: a default wide-angle OPENCV camera, 1920x1080
  std::uint32_t seed = 1;
};

struct SyntheticNoiseOptions {
  double corner_sigma_px = 0.0;
  double missing_rate = 0.0;  // of the detections
  double outlier_rate = 0.0;  // of the detections: moved by outlier_px as a whole
  double outlier_px = 200.0;
  std::uint32_t seed = 1;
};

struct SyntheticScene {
  Layout layout;  // with lines h1..hn for the sail, a part a face for the cube
  Camera camera;
  // By marker id: centre, then corners 1..4; world frame, m. Squares are exact, flat and rigid.
  std::map<int, std::array<Eigen::Vector3d, kNumCorners + 1>> x_in_world;
  std::vector<Rigid3> cam_from_world;   // by frame
  std::vector<FrameDetections> frames;  // image names frame_000000.jpg ...
};

// A marker is seen when it faces the camera within 75 degrees and lies inside the image.
SyntheticScene MakeSyntheticScene(const SyntheticSceneOptions& options);

// Perturbs the detections; the truth stays.
void AddNoise(const SyntheticNoiseOptions& options, SyntheticScene* scene);

}  // namespace velamap
