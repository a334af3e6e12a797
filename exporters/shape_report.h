// Keys of the metrics. Each function adds the figures and tables of one kind to a report.
// exporters/formats/README.md explains the keys.

#pragma once

#include <vector>

#include "exporters/formats/metrics_report.h"
#include "exporters/freeform/freeform_shape.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/model_metrics.h"
#include "exporters/shape/adjacent_distances.h"
#include "exporters/shape/part_planes.h"
#include "exporters/shape/shape_frame.h"
#include "exporters/shape/shape_metrics.h"
#include "reconstruct/model/adjustment_uncertainty.h"

namespace velamap {

// Keys of sigmas exist if the sigmas are known.

// Adds frame_name, frame_description, frame_reasons.
void AddMetrics(const ShapeFrame& frame, MetricsReport* report);

// Adds freeform_notes and table freeform_surfaces.
void AddMetrics(const FreeformShape& freeform, MetricsReport* report);

// Adds num_markers, area_error_mm2, area_error_percent, side_error_mm and table markers. Adds
// num_layout_markers, reconstruction_ratio and missing_marker_ids if the layout names its markers,
// other_marker_ids if the shape has others, and num_sail_markers and sail_reconstruction_ratio if
// the layout has lines.
void AddMetrics(const ShapeMetrics& metrics, MetricsReport* report);

// Adds central_image_name, central_reprojection_error_px, reprojection_error_px, num_behind_camera,
// image_marker_ratio and table images.
void AddMetrics(const ModelMetrics& metrics, MetricsReport* report);

// Adds scale_m_per_unit, scale_sigma_percent, scale_spread_percent and num_scale_markers.
void AddMetrics(const ScaleEstimate& scale, MetricsReport* report);

// Adds tables parts and part_pairs. `covariance` (may be null) gives the sigmas of the pairs.
void AddMetrics(const std::vector<PartPlane>& planes, MetricsReport* report,
                const PointCovariance* covariance = nullptr);

// Adds adjacent_distance_error_mm, adjacent_distance_deviation_percent and table
// adjacent_distances.
void AddMetrics(const std::vector<AdjacentDistance>& distances, MetricsReport* report);

// Adds corners_above_4_sigma_percent, corner_sigma_factor and correlation_factor, and
// rolling_shutter_ms and its sigma if it was estimated.
void AddMetrics(const AdjustmentUncertainty& uncertainty, MetricsReport* report);

// Adds num_points, distance_mm, scale, scale_error_percent, distance_after_scaling_mm and table
// reference_markers.
void AddMetrics(const ReferenceMetrics& comparison, MetricsReport* report);

}  // namespace velamap
