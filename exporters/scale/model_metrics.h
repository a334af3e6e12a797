// How well a model explains its images (thesis section 4.3.2, reprojection error and ratio).

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
  int num_markers = 0;                 // markers of which the image sees all four corners
  std::optional<double> marker_ratio;  // of the markers that the layout names
};

// Errors are |projection - observation| of the corners, px. A point behind its camera has none and
// is counted instead.
struct ModelMetrics {
  // The model's first image; velamap puts the central one of the registration there.
  std::string central_image_name;
  Statistics central_error_px;
  Statistics error_px;  // all images
  int num_behind_camera = 0;
  Statistics marker_ratio;           // over the images; without values where there is no ratio
  std::vector<ImageMetrics> images;  // by name
};

// `layout_ids` are the markers that the layout names, ascending; empty: no ratio. Throws DataError
// for a model without images.
ModelMetrics ComputeModelMetrics(const Model& model, const std::vector<int>& layout_ids);

}  // namespace velamap
