// Audits the metric scale: single markers, groups of markers against all others, width against
// height, known distances, and the spread of the print.
//
// The deviation of a marker is the scale from its side alone over the scale of the shape, minus 1,
// as in scale.csv: positive for a marker that is too small in the shape.

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
  double length_m = 0.0;  // printed side in the layout
  double side_m = 0.0;    // mean of the four sides from the images; of bent markers, along the bend
  double deviation = 0.0;
  std::optional<double> sigma;    // of the deviation, from the noise of the image points
  std::optional<double> side_px;  // size in the images
  // Difference from the mean over sqrt(sigma^2 + marker_spread^2); from the mean of its part where
  // parts disagree.
  double sigmas_off = 0.0;
  // Whether sigmas_off exceeds 3: badly printed, bent, or of another size.
  bool Disagrees() const;
};

// The scale of a group of markers compared with that of all other markers.
struct GroupScale {
  std::string part;       // of a group by part
  double length_m = 0.0;  // of a group by printed size
  int num_markers = 0;
  double deviation = 0.0;  // of the group's scale from the scale of all other markers
  std::optional<double> sigma;
};

struct HistogramBin {
  double from = 0.0, to = 0.0;  // deviations; only the last bin includes `to`
  int num_markers = 0;
};

struct ScaleAudit {
  bool markers_bend = false;         // AdjustmentUncertainty::markers_bend
  std::vector<MarkerScale> markers;  // by id
  // Mean over the markers that agree, and its sigma from their noise and scatter.
  double deviation = 0.0;
  std::optional<double> deviation_sigma;
  // Robust standard deviation of the scales of the markers (where parts disagree: around the mean
  // of their part) in addition to the noise of their image points (without a model, all of it):
  // print, bends, and errors of the cameras.
  double marker_spread = 0.0;
  std::vector<HistogramBin> histogram;
  // Mean horizontal over mean vertical side: 1 for a square print.
  std::optional<double> x_over_y;
  std::optional<double> x_over_y_sigma;
  std::vector<GroupScale> parts;  // by name; empty for fewer than two parts
  // Whether a part differs from the others by more than 3 sigmas: no marker of it is a bad print
  // for that reason.
  bool parts_disagree = false;
  std::vector<GroupScale> sizes;  // ascending; empty for fewer than two sizes
  PrintSpread spread;
  std::vector<CheckedDistance> distances;
  // Mean of reconstructed / measured - 1 over the distances used as checks, and its sigma.
  std::optional<double> distance_deviation;
  std::optional<double> distance_deviation_sigma;
  // From the adjustment, if it estimated one.
  std::optional<UncertainValue> apparent_inset_px;
};

// `model`, at any scale, is the source of the shape; it gives the markers their sigmas and sizes in
// the images. With its `uncertainty`, the sides are measured again from the image points alone with
// fixed cameras, because the adjustment has pulled the markers to their printed size, and distances
// get sigmas. If it says that markers bend, their sides are measured along the bend.
ScaleAudit AuditScale(const MarkerShape& shape, const Layout& layout, const Model* model = nullptr,
                      const AdjustmentUncertainty* uncertainty = nullptr);

}  // namespace velamap
