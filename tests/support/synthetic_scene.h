// Scenes of markers on a known surface with known cameras and exact truth. A scene has no noise
// unless AddNoise() adds it.

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/camera/camera.h"
#include "importer/detect/detection.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/layout.h"

namespace velamap {

enum class SceneKind {
  kSail,   // lines of markers on a cambered sheet; the camera sweeps past it as in a video
  kPlane,  // a flat board
  kCube,   // markers on six faces, of which an image shows at most three; seen from all around
};

struct SyntheticSceneOptions {
  SceneKind kind = SceneKind::kSail;
  int num_rows = 5;  // of markers (per face for kCube)
  int num_columns = 6;
  double marker_length_m = 0.1;
  double spacing_m = 0.25;  // between marker centres
  int num_frames = 21;
  bool video = true;  // frames have numbers and times
  Camera camera;      // if its size is zero, a default wide-angle OPENCV camera of 1920x1080
  std::uint32_t seed = 1;
};

struct SyntheticNoiseOptions {
  double corner_sigma_px = 0.0;
  double missing_rate = 0.0;  // fraction of the detections that are removed
  double outlier_rate = 0.0;  // fraction of the detections that are moved by outlier_px as a whole
  double outlier_px = 200.0;
  std::uint32_t seed = 1;
  // Of the errors of two corners of a detection, along the same coordinate.
  double corner_correlation = 0.0;
};

struct SyntheticScene {
  Layout layout;  // with lines h1..hn for the sail, and a part for each face of the cube
  Camera camera;
  // By marker id, the centre and corners 1..4 in the world frame, m. Markers are exact flat
  // squares.
  std::map<int, std::array<Eigen::Vector3d, kNumCorners + 1>> x_in_world;
  std::vector<Rigid3> cam_from_world;   // by frame
  std::vector<FrameDetections> frames;  // image names frame_000000.jpg ...
};

// A marker is seen if it faces the camera within 75 degrees and is inside the image.
SyntheticScene MakeSyntheticScene(const SyntheticSceneOptions& options);

// Perturbs the detections, but not the truth.
void AddNoise(const SyntheticNoiseOptions& options, SyntheticScene* scene);

// Enlarges the pictures about their middle from this frame on, as a lens that zooms does.
void ZoomFrom(std::size_t first_frame_idx, double zoom, SyntheticScene* scene);

// The same for any frames, such as every other one.
void ZoomWhere(const std::function<bool(std::size_t frame_idx)>& is_zoomed, double zoom,
               SyntheticScene* scene);

}  // namespace velamap
