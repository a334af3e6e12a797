// Scenes for rendered clips: surfaces with markers, the path of the camera, and the exact truth.
//
// World frame, m: z is up, and the camera is on the side of -y with x to its right. It is also the
// shape frame of the truth.

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/camera/camera.h"
#include "importer/geometry/rigid3.h"
#include "importer/layout/dictionary.h"
#include "importer/layout/layout.h"

namespace velamap {

enum class ClipKind {
  kSail,   // thesis section 4.3: 114 markers of 100 mm on a sail and 8 on a rigid strip of the hull
  kBoard,  // thesis Figure 4.1: 12 markers of 40 mm on a flat board
  kWalls,  // thesis Figure 4.10a: two walls at a right angle, 20 markers of 100 mm on each
};

struct ClipOptions {
  ClipKind kind = ClipKind::kSail;
  int dictionary_bits = 4;       // 4, 5: DICT_4X4_250, DICT_5X5_250; 3: the 3x3 bits of the thesis
  int border_bits = 1;           // width of the black border, cells
  double marker_length_m = 0.0;  // 0: each scene's own
  int width_px = 1920;           // of a 16:9 picture; the focal length scales with it
  bool wide_angle = true;        // an action camera instead of a webcam
  std::optional<Camera> camera;  // instead of these two, 16:9; scaled to the width
  int num_frames = 200;
  double fps = 30.0;
  double distance_m = 6.0;  // from the camera to the middle of the scene
  double angle_deg = 0.0;   // between the viewing direction and the frontal view
  double drift_deg = 0.0;   // angle by which the camera circles to either side; 0: scene's own
  // Motion of the board in the thesis's Figure 4.3, 'a' to 'h'. Only for kBoard.
  char motion = 'd';
  double sail_scale = 1.0;  // of the sail alone; fewer markers fit on a small sail
  // Amplitude of slow flapping. A clip holds whole periods, so that the truth is the mean shape.
  double sail_motion_m = 0.0;
  double shake_deg = 0.0;  // amplitude of fast rotations of the camera
  // Time from the first row to the last; negative if the sensor is read upwards. Poses are those of
  // the middle row.
  double rolling_shutter_s = 0.0;
  double trim_change_m = 0.0;     // largest displacement when the trim changes, halfway in the clip
  double margin_sides = 0.15;     // white paper around a marker, as a fraction of its side
  double ink_spread_mm = 0.0;     // by how much dark cells exceed their outlines; may be negative
  double background_level = 0.0;  // reflectance of the surface under the markers; 0: scene's own
  bool busy = false;              // clutter behind the scene and on the cloth
  std::uint32_t seed = 1;
};

// A point of a surface: its world positions before and after the trim changes, and its flapping.
struct ClipVertex {
  Eigen::Vector3d x_before_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d x_after_m = Eigen::Vector3d::Zero();
  double flap = 0.0;  // amplitude as a fraction of ClipOptions::sail_motion_m
  double flap_phase_rad = 0.0;
};

// A surface that is divided into tiles. It has (num_columns + 1) x (num_rows + 1) vertices, row by
// row from the top.
struct ClipSheet {
  int num_columns = 0;
  int num_rows = 0;
  std::vector<ClipVertex> vertices;
  double gray = 0.0;  // light in full sun; 255 for white
};

// A printed marker with its white margin. Its tiles are half cells and, along the outlines of
// cells, narrow seams for the spread of the ink. The corners are those of the square without this
// spread.
struct ClipMarker {
  int marker_id = 0;
  std::string part;
  double ground_gray = 0.0;  // of the surface under the marker
  ClipSheet sheet;           // num_columns == num_rows; gray unused
  cv::Mat inked;             // 1 where a tile of the sheet is inked; CV_8UC1
  cv::Mat cells;             // 1 white, 0 black; including the border; CV_8UC1
  std::array<ClipVertex, kNumCorners> corners;
};

// A painted quad on a surface between the markers.
struct ClipPaint {
  std::array<ClipVertex, 4> corners;  // from the top left, clockwise
  double gray_change = 0.0;
};

// The cam_from_world pose by frame number, which may be fractional.
using CameraPath = std::function<Rigid3(double frame)>;

struct ClipScene {
  ClipOptions options;
  Layout layout;
  Dictionary dictionary;
  Camera camera;
  std::vector<ClipSheet> sheets;  // do not occlude each other
  std::vector<ClipMarker> markers;
  std::vector<ClipPaint> paint;
  CameraPath cam_from_world;
};

// Throws InputError for options out of range.
ClipScene MakeClipScene(const ClipOptions& options);

// The world position of a vertex, m, at a frame number, which may be fractional.
Eigen::Vector3d PositionInFrame(const ClipScene& scene, const ClipVertex& vertex, double frame);

// The mean shape before (or after) the trim changes. Its corners count as seen in all frames.
MarkerShape TrueShape(const ClipScene& scene, bool after);

}  // namespace velamap
