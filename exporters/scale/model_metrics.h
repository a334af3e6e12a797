// Reprojection errors and marker ratios of a model's images (thesis section 4.3.2).

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "importer/base/statistics.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ImageMetrics {
  std::string image_name;
  Statistics error_px;
  int num_markers = 0;                 // markers with all four corners seen
  std::optional<double> marker_ratio;  // share of the markers in the layout
};

// Errors are |projection - observation| of the corners, px. Points behind their camera have no
// error and are counted.
struct ModelMetrics {
  // The model's first image, which is the central image of the registration.
  std::string central_image_name;
  Statistics central_error_px;
  Statistics error_px;  // all images
  int num_behind_camera = 0;
  Statistics marker_ratio;           // over the images; empty if there is no ratio
  std::vector<ImageMetrics> images;  // by name
};

// `layout_ids` are the markers of the layout, ascending; if empty, there is no ratio. Throws
// DataError for a model without images.
ModelMetrics ComputeModelMetrics(const Model& model, const std::vector<int>& layout_ids);

}  // namespace velamap
