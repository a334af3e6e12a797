// Assembles a clip's scene: sheets, stickers on them, paint between the stickers.

#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/clip_scene.h"
#include "tests/support/cloth.h"

namespace velamap {

// A surface under both trims; equal ones where nothing changes.
struct Ground {
  Surface before, after;
  bool flaps = false;
  double gray = 200.0;  // unless the options set background_level
};

class ClipSceneBuilder {
 public:
  ClipSceneBuilder(const ClipOptions& options, double marker_length_m);

  void AddSheet(const Ground& ground, int num_columns, int num_rows);

  // A sticker with its centre at `uv`, upright along growing v. Returns its id. Throws InputError
  // where its margin reaches that of another.
  int AddMarker(const Ground& ground, const std::string& part, const Eigen::Vector2d& uv);

  // Paints the quad unless a sticker is near or, with `alone`, other lone paint; corners from the
  // top left, clockwise.
  void AddPaint(const Ground& ground, const std::array<Eigen::Vector2d, 4>& corners_uv,
                double gray_change, bool alone);

  ClipScene& scene() { return scene_; }

 private:
  double GroundGray(const Ground& ground) const;
  double StickerSize() const;  // m, with its margins
  void CheckRoom(const Eigen::Vector3d& center_m) const;

  ClipScene scene_;
  std::vector<Eigen::Vector3d> centers_m_;                      // of the stickers
  std::vector<std::pair<Eigen::Vector3d, double>> lone_paint_;  // middle and reach, m
};

}  // namespace velamap
