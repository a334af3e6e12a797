#include "exporters/scale/model_metrics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "importer/base/error.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

struct ImageErrors {
  std::vector<double> errors_px;
  std::map<int, std::set<int>> corners_of_marker;
};

ImageMetrics MetricsOfImage(const ModelImage& image, const ImageErrors& errors,
                            const std::vector<int>& layout_ids) {
  ImageMetrics metrics;
  metrics.image_name = image.name;
  metrics.error_px = ComputeStatistics(errors.errors_px);
  int num_in_layout = 0;
  for (const auto& [marker_id, corners] : errors.corners_of_marker) {
    if (corners.size() < kNumCorners) continue;
    ++metrics.num_markers;
    if (std::binary_search(layout_ids.begin(), layout_ids.end(), marker_id)) ++num_in_layout;
  }
  if (!layout_ids.empty()) {
    metrics.marker_ratio = static_cast<double>(num_in_layout) / layout_ids.size();
  }
  return metrics;
}

}  // namespace

ModelMetrics ComputeModelMetrics(const Model& model, const std::vector<int>& layout_ids) {
  if (model.images.empty()) throw DataError("the model has no images, so no reprojection error");
  ModelMetrics metrics;
  std::map<ImageId, ImageErrors> errors_of;
  std::vector<double> all_errors_px;
  for (const ObservationError& error : ComputeReprojectionErrors(model)) {
    ImageErrors& image = errors_of[error.element.image_id];
    if (IsCornerPoint3DId(error.point3D_id)) {
      const CornerId corner = CornerFromPoint3DId(error.point3D_id);
      image.corners_of_marker[corner.marker_id].insert(corner.corner);
    }
    if (std::isfinite(error.error_px)) {
      image.errors_px.push_back(error.error_px);
      all_errors_px.push_back(error.error_px);
    } else {
      ++metrics.num_behind_camera;
    }
  }
  metrics.error_px = ComputeStatistics(std::move(all_errors_px));
  std::vector<double> ratios;
  for (const ModelImage& image : model.images) {
    metrics.images.push_back(MetricsOfImage(image, errors_of[image.image_id], layout_ids));
    const ImageMetrics& image_metrics = metrics.images.back();
    if (image_metrics.marker_ratio) ratios.push_back(*image_metrics.marker_ratio);
  }
  metrics.marker_ratio = ComputeStatistics(std::move(ratios));
  metrics.central_image_name = metrics.images.front().image_name;
  metrics.central_error_px = metrics.images.front().error_px;
  std::sort(metrics.images.begin(), metrics.images.end(),
            [](const auto& a, const auto& b) { return a.image_name < b.image_name; });
  return metrics;
}

}  // namespace velamap
