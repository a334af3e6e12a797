// All parameters of the marker-aware bundle adjustment.

#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/layout/layout.h"
#include "reconstruct/model/model.h"
#include "reconstruct/problem/marker_chords.h"

namespace velamap {

struct MarkerBlock {
  int marker_id = 0;
  std::string part;          // of the layout
  std::vector<int> corners;  // the corners, 1..4, that are in the model, ascending
  std::array<double, 3 * kNumCorners> x_in_world{};  // x y z of each of them, m
  double length_m = 0.0;                             // side by the layout
  MarkerChords chords;
  bool is_rigid = false;

  int NumCoordinates() const { return 3 * static_cast<int>(corners.size()); }
};

struct ImageBlock {
  ImageId image_id = 0;
  CameraId camera_id = 0;
  std::array<double, 7> cam_from_world{};
};

// The pose of the first image fixes the gauge.
struct MarkerState {
  std::vector<MarkerBlock> markers;  // by ascending id
  std::vector<ImageBlock> images;    // in the order of the model
  std::map<CameraId, std::vector<double>> intrinsics;
  double rolling_shutter_s = 0.0;  // readout time, from the first row of an image to the last
  double inset_px = 0.0;
  double print_scale = 0.0;
  // Scale of the prints of each part, minus 1, in addition to print_scale.
  std::map<std::string, double> part_scales;
};

Eigen::Map<const Eigen::Vector3d> CornerPosition(const MarkerBlock& marker, int slot);

// Takes points, poses and cameras from the model, lengths and rigid parts from the layout. Throws
// DataError for a point that is not a marker corner.
MarkerState MakeMarkerState(const Model& model, const Layout& layout);

// Writes points, poses and cameras of the state into the model.
void WriteMarkerState(const MarkerState& state, Model* model);

}  // namespace velamap
