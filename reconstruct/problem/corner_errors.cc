#include "reconstruct/problem/corner_errors.h"

#include <algorithm>

#include "reconstruct/problem/marker_adjustment_options.h"

namespace velamap {

CornerErrors CornerErrorsOf(const std::vector<DatabaseImage>& images,
                            const std::optional<FormationEstimate>& formation) {
  // Corners of the fallback estimator have about this many times the default sigma.
  constexpr double kFallbackFactor = 5.0;
  constexpr double kInsetWithoutEstimate_px = 0.01;
  const double fallback_px = kFallbackFactor * MarkerAdjustmentOptions{}.corner_sigma_px;
  CornerErrors errors;
  errors.motions = CornerMotionsOf(images);
  errors.common_inset_px = formation ? formation->inset_sigma_px : kInsetWithoutEstimate_px;
  for (const DatabaseImage& image : images) {
    std::vector<double>& sigmas_px = errors.sigmas_px[image.image_id];
    for (const MarkerDetection& marker : image.detections.markers) {
      for (const double sigma_px : marker.corner_sigma_px) {
        sigmas_px.push_back(marker.is_fallback ? std::max(sigma_px, fallback_px) : sigma_px);
      }
    }
  }
  return errors;
}

}  // namespace velamap
