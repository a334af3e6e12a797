// Assembles the scene of a clip: sheets, stickers on the sheets, and paint between the stickers.

#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/clip/clip_scene.h"
#include "tests/support/clip/cloth.h"

namespace velamap {

// A surface before and after the trim changes.
struct Ground {
  Surface before, after;
  bool flaps = false;
  double gray = 200.0;  // unless the options set background_level
};

class ClipSceneBuilder {
 public:
  ClipSceneBuilder(const ClipOptions& options, double marker_length_m);

  void AddSheet(const Ground& ground, int num_columns, int num_rows);

  // Adds a sticker with its centre at `uv`, whose upward direction is that of growing v. Returns
  // its marker id. Throws InputError if its margin reaches that of another sticker.
  int AddMarker(const Ground& ground, const std::string& part, const Eigen::Vector2d& uv);

  // Paints a quad, with the corners clockwise from the top left. Skips it if a sticker is near or,
  // with `alone`, if other paint that was added with `alone` is near.
  void AddPaint(const Ground& ground, const std::array<Eigen::Vector2d, 4>& corners_uv,
                double gray_change, bool alone);

  ClipScene& scene() { return scene_; }

 private:
  double GroundGray(const Ground& ground) const;
  double StickerSize() const;  // m, with its margins
  void CheckRoom(const Eigen::Vector3d& center_m) const;

  ClipScene scene_;
  std::vector<Eigen::Vector3d> centers_m_;                      // of the stickers
  std::vector<std::pair<Eigen::Vector3d, double>> lone_paint_;  // centre and radius, m
};

}  // namespace velamap
