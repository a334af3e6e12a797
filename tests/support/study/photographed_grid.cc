#include "tests/support/study/photographed_grid.h"

#include <opencv2/imgproc.hpp>

namespace velamap {

MarkerGrid PhotographedGrid(const ClipScene& scene, const SurfaceRenderOptions& rendering) {
  MarkerGrid grid;
  cv::cvtColor(RenderClipFrame(scene, rendering, 0), grid.image, cv::COLOR_BGR2GRAY);
  for (const ClipMarker& marker : scene.markers) {
    const auto corners = ProjectCorners(scene, marker, 0);
    if (!corners) continue;
    QuadCorners truth = *corners;
    for (Eigen::Vector2d& x_px : truth) x_px -= Eigen::Vector2d::Constant(kImageFromOpenCvPx);
    grid.truth.push_back(truth);
    grid.starts.push_back(truth);
    grid.cells.push_back(255 * marker.cells);
  }
  return grid;
}

}  // namespace velamap
