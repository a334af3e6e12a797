// The sides of whole markers, and how well the images alone determine them.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct MarkerSidesMeasured {
  int marker_id = 0;
  std::string part;
  std::array<double, kNumCorners> sides{};  // 1-2, 2-3, 3-4, 4-1; m for a metric shape
  // 1 sigma by the noise of the corners in the images, as a fraction, the cameras taken as exact:
  // of the mean side, and of the ratio of the horizontal sides to the vertical ones. Nothing
  // without a model, or where fewer than two images see a corner.
  std::optional<double> mean_sigma;
  std::optional<double> ratio_sigma;
  // Mean side in the images, px, each image weighted by it, as its say in the size is.
  std::optional<double> side_px;

  double Mean() const;
  double HorizontalOverVertical() const;
};

// Of the whole markers, by id, without what needs images.
std::vector<MarkerSidesMeasured> MeasureSides(const MarkerShape& shape);

// With it: the noise is that of the marker's own residuals, drawn a little towards the median of
// all markers.
std::vector<MarkerSidesMeasured> MeasureSides(const Model& model, const Layout& layout);

// Moves every point to where its image points alone place it (least squares, cameras held): what an
// adjustment that knows the markers' size has drawn to that size is freed again. The image points
// are first moved out of the marker by `apparent_inset_px` (AdjustmentUncertainty). Points that
// fewer than two images see, or that do not converge, stay.
void IntersectCorners(double apparent_inset_px, Model* model);

}  // namespace velamap
