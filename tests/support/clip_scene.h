// Scenes for rendered clips: surfaces with markers on them, the camera's path, and the exact truth.
//
// World frame: z up, the camera on the side of -y and x to its right; m. The world frame is the
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
  kSail,   // thesis section 4.3: 114 markers of 100 mm on a sail, 8 on a rigid strip of the hull
  kBoard,  // thesis Figure 4.1: 12 markers of 40 mm on a flat board
  kWalls,  // thesis Figure 4.10a: two walls at a right angle, 20 markers of 100 mm on each
};

struct ClipOptions {
  ClipKind kind = ClipKind::kSail;
  int dictionary_bits = 4;       // 4, 5: DICT_4X4_250, DICT_5X5_250; 3: the 3x3 bits of the thesis
  int border_bits = 1;           // width of the black border, cells
  double marker_length_m = 0.0;  // 0: each scene's own
  int width_px = 1920;           // 16:9; the lens scales with it
  bool wide_angle = true;        // an action camera's lens instead of a webcam's
  std::optional<Camera> camera;  // instead of both, 16:9; scaled to the width
  int num_frames = 200;
  double fps = 30.0;
  double distance_m = 6.0;  // of the camera from the scene's middle
  double angle_deg = 0.0;   // of the view from straight on
  double drift_deg = 0.0;   // by which the camera goes around to either side; 0: each scene's own
  // Motion of the board in the thesis's Figure 4.3, 'a' to 'h'; for the board only.
  char motion = 'd';
  double sail_scale = 1.0;     // size of the sail; markers keep theirs, so fewer fit on a small one
  double sail_motion_m = 0.0;  // amplitude of slow flapping, whole periods in a clip: truth = mean
  double shake_deg = 0.0;      // amplitude of the camera's fast turns
  // From the first row to the last; negative: read upwards. Poses are those of the middle row.
  double rolling_shutter_s = 0.0;
  double trim_change_m = 0.0;  // largest displacement when the trim changes, halfway
  double margin_sides = 0.15;  // white paper around a marker, part of its side
  double ink_spread_mm =
      0.0;  // dark cells reach that far beyond their outlines; negative: less far
  double background_level = 0.0;  // reflectance of what the markers stick to; 0: each scene's own
  bool busy = false;              // clutter behind the scene and on the cloth
  std::uint32_t seed = 1;
};

// A point of a surface: where it is under both trims, and how it flaps.
struct ClipVertex {
  Eigen::Vector3d x_before_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d x_after_m = Eigen::Vector3d::Zero();
  double flap = 0.0;  // amplitude as a part of the largest
  double flap_phase_rad = 0.0;
};

// A surface cut into tiles: (num_columns + 1) x (num_rows + 1) vertices, row by row from the top.
struct ClipSheet {
  int num_columns = 0;
  int num_rows = 0;
  std::vector<ClipVertex> vertices;
  double gray = 0.0;  // light in full sun, 255 at white
};

// A printed square with its white margin, in tiles of half a cell and of the seams that ink that
// spreads adds along the outlines of cells. The corners are those of the square as it was meant.
struct ClipMarker {
  int marker_id = 0;
  std::string part;
  double ground_gray = 0.0;  // of the surface it sticks to
  ClipSheet sheet;           // num_columns == num_rows; gray unused
  cv::Mat inked;             // 1 where a tile of the sheet is inked; CV_8UC1
  cv::Mat cells;             // 1 white, 0 black; with border; CV_8UC1
  std::array<ClipVertex, kNumCorners> corners;
};

// Paint on a surface between the markers.
struct ClipPaint {
  std::array<ClipVertex, 4> corners;  // from the top left, clockwise
  double gray_change = 0.0;
};

// By the number of the frame, also between frames.
using CameraPath = std::function<Rigid3(double frame)>;

struct ClipScene {
  ClipOptions options;
  Layout layout;
  Dictionary dictionary;
  Camera camera;
  std::vector<ClipSheet> sheets;  // no two overlap in a picture
  std::vector<ClipMarker> markers;
  std::vector<ClipPaint> paint;
  CameraPath cam_from_world;
};

// Throws InputError for options out of range.
ClipScene MakeClipScene(const ClipOptions& options);

// World position of a vertex, m, in a frame or between frames.
Eigen::Vector3d PositionInFrame(const ClipScene& scene, const ClipVertex& vertex, double frame);

// The mean shape before (or after) the trim changes; all frames count for every corner.
MarkerShape TrueShape(const ClipScene& scene, bool after);

}  // namespace velamap
