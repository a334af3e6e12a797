// The sides of whole markers, and their sigmas from the images alone.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct MeasuredMarkerSides {
  int marker_id = 0;
  std::string part;
  std::array<double, kNumCorners> sides{};  // 1-2, 2-3, 3-4, 4-1; m for a metric shape
  // Relative 1 sigma of the mean side and of the ratio of the horizontal to the vertical sides,
  // from the noise of the corners in the images, as if the cameras were exact. Nothing without a
  // model, or if fewer than two images see a corner.
  std::optional<double> mean_sigma;
  std::optional<double> ratio_sigma;
  // Mean side in the images, px, weighted by the side itself.
  std::optional<double> side_px;

  double HorizontalOverVertical() const;
};

// Measures the sides of the whole markers, by id. Members that need images stay empty.
std::vector<MeasuredMarkerSides> MeasureSides(const MarkerShape& shape);

// The same with the images of a model. The noise of a marker follows from its own residuals, with a
// weak prior at the median of all markers.
std::vector<MeasuredMarkerSides> MeasureSides(const Model& model, const Layout& layout);

// Triangulates every point again, from its image points alone (least squares, fixed cameras),
// because an adjustment that knows the size of the markers has pulled the points to that size.
// First moves the image points out of the marker by `apparent_inset_px` (AdjustmentUncertainty).
// Points that fewer than two images see, or that do not converge, stay.
void RetriangulateCorners(double apparent_inset_px, Model* model);

}  // namespace velamap
