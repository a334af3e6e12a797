// Renders the frames of a clip as a camera takes them. Surfaces with their markers are drawn in
// linear light, darkened by shadows, and blurred by lens and motion before the sensor takes its
// means over pixels; sea, sky, reflections, veiling glare and noise are added. The response of the
// camera (camera_response.h) and 8 bits come last; with a linear response and no glare, grey values
// equal light. The same scene, options and frame give the same bytes. Several threads may render
// frames.

#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "tests/support/clip/camera_response.h"
#include "tests/support/clip/clip_scene.h"

namespace velamap {

struct SurfaceRenderOptions {
  double blur_px = 0.7;         // sigma of the lens blur, in addition to the area of a pixel
  double defocus_px = 0.0;      // radius of the disc as which a point appears out of focus
  double halo = 0.0;            // share of the light that is scattered over a Gaussian of
  double halo_px = 3.0;         // this sigma
  double motion_blur_px = 0.0;  // motion during the exposure; its direction differs between frames
  double noise = 2.0;           // standard deviation of the read noise, in light (0 to 255)
  double shot_noise = 0.0;      // standard deviation of the shot noise at full light
  int num_reflections = 0;      // bright patches on the scene's last sheet that hide markers
  int num_shadows = 0;          // bands across the scene's last sheet (shadows.h)
  double shadow_depth = 0.5;    // share of the light that the darkest of them takes
  double glare = 0.0;           // light scattered over all pixels, as a fraction of full light
  double ink_level = 38.0 / 255;     // reflectance of printed cells
  double paper_level = 218.0 / 255;  // reflectance of the paper
  CameraResponse response;

  void Check() const;  // throws InputError
};

// An 8-bit BGR picture of the camera's size.
cv::Mat RenderClipFrame(const ClipScene& scene, const SurfaceRenderOptions& options, int frame_idx);

// The true corners in the image frame, px, or nothing if the marker is not wholly in the picture or
// faces away from the camera.
std::optional<std::array<Eigen::Vector2d, kNumCorners>> ProjectCorners(const ClipScene& scene,
                                                                       const ClipMarker& marker,
                                                                       int frame_idx);

}  // namespace velamap
