// Errors of a shape taken by itself (thesis section 4.3.2) and against a reference.

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/base/statistics.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

// Unsigned errors of a whole marker against its printed size.
struct MarkerMetrics {
  int marker_id = 0;
  std::string part;
  double area_error_mm2 = 0.0;
  double area_error_percent = 0.0;  // of the printed area
  double side_error_mm = 0.0;       // mean of the four sides
  double mean_side_mm = 0.0;        // mean of the four reconstructed sides
  // 1 sigma of the area and of mean_side_mm.
  std::optional<double> area_sigma_mm2;
  std::optional<double> mean_side_sigma_mm;
};

struct ShapeMetrics {
  Statistics area_error_mm2;      // |reconstructed - printed area| of whole markers
  Statistics area_error_percent;  // of the printed area
  Statistics side_error_mm;       // |reconstructed - printed side|, four per marker
  int num_markers = 0;            // whole markers
  std::optional<int> num_layout_markers;
  // Whole markers that the layout does not name, counted in num_markers and in no ratio.
  std::vector<int> other_marker_ids;

  int NumWholeOfLayout() const { return num_markers - static_cast<int>(other_marker_ids.size()); }
  std::optional<double> reconstruction_ratio;  // of the markers that the layout names
  // The same for the parts with lines of markers, as the thesis counts (4.3.2): the sail without
  // the hull. Nothing if the layout has no lines.
  std::optional<int> num_sail_markers;
  std::optional<double> sail_reconstruction_ratio;
  std::vector<int> missing_marker_ids;  // in the layout but not whole
  std::vector<MarkerMetrics> markers;   // whole markers, by id
  // Roots of the mean variances: the rms errors that the uncertainty of the corners explains.
  std::optional<double> area_sigma_mm2;
  std::optional<double> side_sigma_mm;
};

// Compares markers with their printed sides in `layout`. Sigmas are known if `covariance`, of the
// corners of the shape, has all whole markers. Throws DataError if the shape has markers and the
// layout names none of them.
ShapeMetrics ComputeShapeMetrics(const MarkerShape& shape, const Layout& layout,
                                 const PointCovariance* covariance = nullptr);

// Means over the common corners of a marker.
struct MarkerDistance {
  int marker_id = 0;
  int num_corners = 0;
  double distance_m = 0.0;
  double distance_after_scaling_m = 0.0;
};

struct ReferenceMetrics {
  int num_points = 0;
  Statistics distance_m;  // of common points after rigid alignment without scale
  double scale = 1.0;     // this shape / reference, from the alignment with scale
  Statistics distance_after_scaling_m;
  // Expected distance_m.rms and distance_after_scaling_m.rms if the reference were exact: roots of
  // the mean variance of the points after these alignments. Without a covariance, the first one
  // comes from the sigmas of the points, if the shape has them.
  std::optional<double> distance_sigma_m;
  std::optional<double> distance_after_scaling_sigma_m;
  std::vector<MarkerDistance> markers;  // by id
};

// Aligns common corners (not centres) by least squares. `covariance`, of the corners of the shape,
// is used if it has all common corners. Throws DataError with fewer than three common corners or if
// they all lie in one point.
ReferenceMetrics ComputeReferenceMetrics(const MarkerShape& shape, const MarkerShape& reference,
                                         const PointCovariance* covariance = nullptr);

}  // namespace velamap
