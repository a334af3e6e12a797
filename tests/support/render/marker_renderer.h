// Renders pictures of markers with exact truth. Every pixel is the mean over its area of what the
// camera sees there, blurred by its lens; noise is added afterwards. Image frame as in COLMAP: the
// centre of the first pixel is at (0.5, 0.5). The same options give the same bytes.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/camera/camera.h"
#include "importer/layout/dictionary.h"
#include "importer/pattern/image_formation.h"
#include "tests/support/synthetic_scene.h"

namespace velamap {

// A flat square marker with its top-left, top-right, bottom-right and bottom-left corner in the cam
// frame, m. The third corner is not used because it follows from the others.
struct PlacedMarkerInCam {
  int marker_id = 0;
  std::array<Eigen::Vector3d, kNumCorners> corners_in_cam;
};

struct RenderOptions {
  double black = 40.0;  // grey levels
  double white = 200.0;
  double background = 120.0;
  double background_texture = 0.0;    // standard deviation of smooth random patches, grey levels
  double quiet_zone_cells = 1.0;      // white ring around the black square
  double surround_cells = 0.0;        // black ring around the white one, as on a chequered board
  double light_gradient = 0.0;        // relative change of the light across the picture's diagonal
  double blur_sigma_px = 0.7;         // of the lens, in addition to the area of a pixel
  ImageFormationParameters camera{};  // halo, tone curve and sharpening; the rest is not used
  bool sharpens_light = false;        // before the tone curve instead of after it
  double noise_sigma = 0.0;           // grey levels
  int supersampling = 4;              // number of samples along each side of half a pixel
  bool color = false;                 // BGR with three equal channels instead of grey
  std::uint32_t seed = 1;             // of texture and noise
};

// An 8-bit picture of the camera's size. Markers that face away from the camera or extend behind it
// are not drawn. Near markers hide far ones.
cv::Mat RenderMarkers(const Camera& camera, const std::vector<PlacedMarkerInCam>& markers,
                      const Dictionary& dictionary, int border_bits, const RenderOptions& options);

// The markers of a scene in its frame `frame_idx`, with the dictionary and border of the scene's
// layout.
cv::Mat RenderFrame(const SyntheticScene& scene, int frame_idx, const RenderOptions& options);

}  // namespace velamap
