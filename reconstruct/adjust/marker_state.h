// All parameters of the marker-aware bundle adjustment. Private to this room.

#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct MarkerBlock {
  int marker_id = 0;
  std::vector<int> corners;        // 1..4, ascending: those that are in the model
  std::vector<double> x_in_world;  // x y z of each, m
  double length_m = 0.0;           // of the layout
  bool is_rigid = false;
};

struct ImageBlock {
  ImageId image_id = 0;
  CameraId camera_id = 0;
  std::array<double, 7> cam_from_world{};
  std::array<double, 6> velocity{};
};

// All parameters. The first image's pose is the gauge.
struct MarkerState {
  std::vector<MarkerBlock> markers;  // ascending
  std::vector<ImageBlock> images;    // in order of the model
  std::map<CameraId, std::vector<double>> intrinsics;
  double inset_px = 0.0;
  double print_scale = 0.0;
};

Eigen::Map<const Eigen::Vector3d> CornerPosition(const MarkerBlock& marker, int slot);

// Parts of the layout that say which markers are rigid, by marker; and the lengths. Throws
// DataError for a point that is no marker corner.
MarkerState MakeMarkerState(const Model& model, const Layout& layout);

// Poses, points and cameras of the state.
void WriteMarkerState(const MarkerState& state, Model* model);

}  // namespace velamap
