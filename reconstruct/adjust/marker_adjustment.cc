#include "reconstruct/adjust/marker_adjustment.h"

#include <algorithm>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "reconstruct/adjust/marker_adjuster.h"

namespace velamap {
namespace {

void CheckRange(const char* option, double value, double min, double max) {
  if (value >= min && value <= max) return;
  throw InputError(fmt::format("--MarkerAdjustment.{}: {} is out of range; give {} to {}", option,
                               value, min, max));
}

}  // namespace

void MarkerAdjustmentOptions::Check() const {
  CheckRange("corner_sigma", corner_sigma_px, 1e-4, 100);
  CheckRange("corner_sigma_floor", corner_sigma_floor_px, 0, 100);
  CheckRange("loss_sigmas", loss_sigmas, 1, 1000);
  CheckRange("outlier_sigmas", outlier_sigmas, 2, 1000);
  CheckRange("print_tolerance", print_tolerance, 1e-6, 0.5);
  CheckRange("common_print_tolerance", common_print_tolerance, 0, 0.5);
  CheckRange("cloth_flatness", cloth_flatness, 0, 1);
  CheckRange("rigid_flatness", rigid_flatness, 0, 1);
  CheckRange("inset_sigma", inset_sigma_px, 0, 10);
  CheckRange("intrinsics_sigma", intrinsics_sigma, 1e-9, 10);
  CheckRange("rolling_shutter", rolling_shutter_s, 0, 1);
  CheckRange("max_num_iterations", max_num_iterations, 1, 1e6);
  CheckRange("min_track_length", min_track_length, 2, 1e6);
  CheckRange("max_mean_error", max_mean_error_px, 0, 1e6);
  CheckRange("num_threads", num_threads, 0, 1e4);
}

CornerSigmas CornerSigmasOf(const std::vector<DatabaseImage>& images) {
  // What had to fall back is worse than the default says, by about this.
  constexpr double kFallbackFactor = 5.0;
  const double fallback_px = kFallbackFactor * MarkerAdjustmentOptions{}.corner_sigma_px;
  CornerSigmas sigmas;
  for (const DatabaseImage& image : images) {
    std::vector<double>& of_image = sigmas[image.image_id];
    for (const MarkerDetection& marker : image.detections.markers) {
      for (const double sigma_px : marker.corner_sigma_px) {
        of_image.push_back(marker.is_fallback ? std::max(sigma_px, fallback_px) : sigma_px);
      }
    }
  }
  return sigmas;
}

MarkerAdjustmentSummary AdjustWithMarkers(const MarkerAdjustmentOptions& options,
                                          const Layout& layout, const CornerSigmas& corner_sigmas,
                                          Model* model) {
  options.Check();
  CheckModel(*model);
  MarkerAdjuster adjuster(options, layout, corner_sigmas, *model);
  adjuster.PrepareSeed();
  adjuster.AdjustLoosely();
  adjuster.JudgeMarkerSizes();
  adjuster.AdjustTightly();
  if (adjuster.AddScaleBars()) adjuster.AdjustTightly();
  adjuster.Finish();
  *model = adjuster.TakeModel();
  return adjuster.TakeSummary();
}

}  // namespace velamap
