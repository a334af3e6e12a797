// Frames of a clip as a camera takes them: surfaces with their markers before sea and sky and
// reflections, all as linear light; veiling glare, motion and lens blur and noise in that light;
// then the camera's response (camera_response.h) and 8 bits. With a linear response and no glare
// grey values are light. Same scene, options and frame, same bytes; frames may be drawn from
// several threads.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "tests/support/camera_response.h"
#include "tests/support/clip_scene.h"

namespace velamap {

struct SurfaceRenderOptions {
  double blur_px = 0.7;         // sigma of the lens's blur; a pixel's own area comes on top
  double motion_blur_px = 0.0;  // path during the exposure; its direction changes by frame
  double noise = 2.0;           // standard deviation, of light (0 to 255)
  double shot_noise = 0.0;      // the same at full light; it grows with the root of light
  int num_reflections = 0;      // bright patches on the scene's last sheet that wipe out markers
  double glare = 0.0;           // light that the lens scatters over all pixels, part of full light
  double ink_level = 38.0 / 255;     // reflectance of printed cells
  double paper_level = 218.0 / 255;  // and of the paper
  CameraResponse response;

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
