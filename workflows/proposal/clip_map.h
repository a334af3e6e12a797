// The markers of a clip in space, regardless of the parts and lines of a layout.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "importer/layout/layout.h"
#include "reconstruct/geometry/frame_shape.h"

namespace velamap {

struct MarkerSide {
  double length_m = 0.0;
  double sigma_m = 0.0;  // noise of the images, and the scatter of the markers beyond it
};

struct ClipMap {
  // Markers that keep their places relative to each other; most markers first. Each body has a
  // frame of its own.
  std::vector<ShapePoints> bodies;
  std::map<int, MarkerSide> sides;      // of the markers of the bodies
  std::map<int, std::string> left_out;  // why an id is on no body
  std::vector<std::string> duplicates;  // one line for each id that is on the object twice
};

// Registers and adjusts the images of a database. Uses only the dictionary and marker lengths of
// `layout`, not its parts and lines, and measures markers whose length is far from the given one.
// Markers that move relative to the first body are tried as further bodies. Finds the camera if the
// database has no calibration. Throws DataError if the images give no body.
ClipMap MapClip(const std::string& database_path, const Layout& layout, int num_threads);

}  // namespace velamap
