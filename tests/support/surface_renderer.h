// Frames of a clip: surfaces with their markers before sea and sky, reflection, blur and noise.
// Same scene, options and frame, same bytes; frames may be drawn from several threads.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "tests/support/clip_scene.h"

namespace velamap {

struct SurfaceRenderOptions {
  double blur_px = 0.7;         // sigma of the lens's blur; a pixel's own area comes on top
  double motion_blur_px = 0.0;  // path during the exposure; its direction changes by frame
  double noise = 2.0;           // standard deviation, grey levels
  int num_reflections = 0;      // bright patches on the scene's last sheet that wipe out markers

  void Check() const;  // throws InputError
};

// An 8-bit BGR picture of the camera's size.
cv::Mat RenderClipFrame(const ClipScene& scene, const SurfaceRenderOptions& options, int frame_idx);

// True corners in the picture, image frame, px; nothing for a marker that is not wholly in it or
// turns its back.
std::optional<std::array<Eigen::Vector2d, kNumCorners>> ProjectCorners(const ClipScene& scene,
                                                                       const ClipMarker& marker,
                                                                       int frame_idx);

}  // namespace velamap
