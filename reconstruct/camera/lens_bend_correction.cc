#include "reconstruct/camera/lens_bend_correction.h"

#include <algorithm>

#include "importer/bend/pattern_bend.h"

namespace velamap {

void CorrectForLensBend(const std::map<CameraId, Camera>& cameras,
                        std::vector<DatabaseImage>* images) {
  const Eigen::Vector2d image_from_opencv = Eigen::Vector2d::Constant(kImageFromOpenCvPx);
  for (DatabaseImage& image : *images) {
    const auto camera = cameras.find(image.camera_id);
    if (camera == cameras.end()) continue;
    for (MarkerDetection& marker : image.detections.markers) {
      const auto& sigmas_px = marker.corner_sigma_px;
      const bool has_fit =
          !marker.is_fallback && *std::min_element(sigmas_px.begin(), sigmas_px.end()) > 0;
      if (!has_fit) continue;
      QuadCorners corners_px = marker.corners_in_image_px;
      for (Eigen::Vector2d& corner_px : corners_px) corner_px -= image_from_opencv;
      const QuadCorners shifts_px =
          CornerShiftsByBend(BendByLens(camera->second, corners_px), corners_px);
      for (std::size_t i = 0; i < kNumCorners; ++i) {
        marker.corners_in_image_px[i] -= shifts_px[i];
      }
    }
  }
}

}  // namespace velamap
