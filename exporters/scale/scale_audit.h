// What speaks for and against the metric scale: every marker's side by itself, groups of markers
// against the others, width against height, known distances, and what spread of the print is left.
//
// Deviations are of the scale that a marker's side alone gives, over the shape's, less 1, as in
// scale.csv: positive for a marker that is too small in the shape.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/scale/print_spread.h"
#include "exporters/shape/known_distances.h"
#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct MarkerScale {
  int marker_id = 0;
  std::string part;
  double length_m = 0.0;  // printed side, as the layout has it
  double side_m = 0.0;    // mean of the four, as the images see them
  double deviation = 0.0;
  std::optional<double> sigma;    // of the deviation, by the noise of its image points
  std::optional<double> side_px;  // size in the images
  // Difference from the mean over the root of sigma^2 + marker_spread^2.
  double sigmas_off = 0.0;
  bool Disagrees() const;  // more than 3: badly printed, bent, or of another size
};

// A group of markers by itself against all other markers: the scale without it.
struct GroupScale {
  std::string part;       // of a group by part
  double length_m = 0.0;  // of a group by printed size
  int num_markers = 0;
  double deviation = 0.0;  // of the group's own scale from that of all others
  std::optional<double> sigma;
};

struct HistogramBin {
  double from = 0.0, to = 0.0;  // deviations; `to` is part of the last bin only
  int num_markers = 0;
};

struct ScaleAudit {
  std::vector<MarkerScale> markers;  // by id
  // Mean of what agrees, and its sigma by noise and scatter of the markers.
  double deviation = 0.0;
  std::optional<double> deviation_sigma;
  // Robust standard deviation of the markers' scales beyond what the noise of their image points
  // explains (without a model: all of it): print, bends, what cameras share.
  double marker_spread = 0.0;
  std::vector<HistogramBin> histogram;
  // Mean of the horizontal sides over that of the vertical ones: 1 unless the print is not square.
  std::optional<double> x_over_y;
  std::optional<double> x_over_y_sigma;
  std::vector<GroupScale> parts;  // where there are two or more, by name
  std::vector<GroupScale> sizes;  // where there are two or more, ascending
  PrintSpread spread;
  std::vector<CheckedDistance> distances;
  // Mean of reconstructed / measured - 1 over the distances that are checks, and its sigma.
  std::optional<double> distance_deviation;
  std::optional<double> distance_deviation_sigma;
  // Of the adjustment, where it estimated one.
  std::optional<UncertainValue> apparent_inset_px;
};

// `model` is the one that the shape is from, at any scale; with it the markers have sigmas and
// sizes in the images. With `uncertainty` (of that model) their sides are measured anew, by the
// image points alone and the cameras as they are, because the adjustment has drawn them to their
// printed size; distances get sigmas.
ScaleAudit AuditScale(const MarkerShape& shape, const Layout& layout, const Model* model = nullptr,
                      const AdjustmentUncertainty* uncertainty = nullptr);

}  // namespace velamap
