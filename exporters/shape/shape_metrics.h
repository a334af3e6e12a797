// How good a shape is by itself (thesis section 4.3.2) and against a reference.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/base/statistics.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// A whole marker against its printed size, without sign.
struct MarkerMetrics {
  int marker_id = 0;
  std::string part;
  double area_error_mm2 = 0.0;
  double area_error_percent = 0.0;  // of the printed area
  double side_error_mm = 0.0;       // mean of the four
  double mean_side_mm = 0.0;        // of the four, reconstructed
  // 1 sigma of the area, and of mean_side_mm.
  std::optional<double> area_sigma_mm2;
  std::optional<double> mean_side_sigma_mm;
};

struct ShapeMetrics {
  Statistics area_error_mm2;      // |reconstructed - printed area| of whole markers
  Statistics area_error_percent;  // of the printed area
  Statistics side_error_mm;       // |reconstructed - printed side|, four a marker
  int num_markers = 0;            // whole markers
  std::optional<int> num_layout_markers;
  std::optional<double> reconstruction_ratio;  // of the markers that the layout names
  std::vector<int> missing_marker_ids;         // named by the layout, not whole
  std::vector<MarkerMetrics> markers;          // whole ones, by id
  // Roots of the mean variances: what the corners' uncertainty alone makes of the rms errors.
  std::optional<double> area_sigma_mm2;
  std::optional<double> side_sigma_mm;
};

// Markers are judged against their printed sides in `layout`. Sigmas are there where `covariance`,
// of the shape's corners, holds all whole markers.
ShapeMetrics ComputeShapeMetrics(const MarkerShape& shape, const Layout& layout,
                                 const PointCovariance* covariance = nullptr);

// Means over the corners that both shapes have of a marker.
struct MarkerDistance {
  int marker_id = 0;
  int num_corners = 0;
  double distance_m = 0.0;
  double distance_after_scaling_m = 0.0;
};

struct ShapeComparison {
  int num_points = 0;
  Statistics distance_m;  // after rigid alignment without scale, points that both shapes have
  double scale = 1.0;     // this shape / reference, from the alignment with scale
  Statistics distance_after_scaling_m;
  // What distance_m.rms and distance_after_scaling_m.rms would be if the reference were the truth:
  // roots of the points' mean variance after these very alignments. Without a covariance the first
  // is that of the points' own sigmas, where the shape has them.
  std::optional<double> distance_sigma_m;
  std::optional<double> distance_after_scaling_sigma_m;
  std::vector<MarkerDistance> markers;  // by id
};

// Aligns common corners (not centres) by least squares. `covariance` is that of the shape's
// corners; it counts where it holds all common ones. Throws DataError with fewer than three, or
// when they all lie in one point.
ShapeComparison CompareShapes(const MarkerShape& shape, const MarkerShape& reference,
                              const PointCovariance* covariance = nullptr);

}  // namespace velamap
