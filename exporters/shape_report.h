// What the metrics are called: one function a kind, each adds its figures and tables to a report.
// The keys and what they mean stand in the README of this room.

#pragma once

#include <vector>

#include "exporters/formats/metrics_report.h"
#include "exporters/sail/sail_shape.h"
#include "exporters/scale/metric_scale.h"
#include "exporters/scale/model_metrics.h"
#include "exporters/shape/adjacent_distances.h"
#include "exporters/shape/part_planes.h"
#include "exporters/shape/shape_frame.h"
#include "exporters/shape/shape_metrics.h"
#include "reconstruct/model/adjustment_uncertainty.h"

namespace velamap {

// Keys of sigmas are there where the sigmas are.

// frame_name, frame_description, frame_reasons.
void AddMetrics(const ShapeFrame& frame, MetricsReport* report);

// section_notes, surface_notes; table surfaces. The sections have files of their own.
void AddMetrics(const SailShape& sail, MetricsReport* report);

// num_markers, area_error_mm2, area_error_percent, side_error_mm; where the layout names its
// markers, num_layout_markers, reconstruction_ratio and missing_marker_ids. Table markers.
void AddMetrics(const ShapeMetrics& metrics, MetricsReport* report);

// central_image_name, central_reprojection_error_px, reprojection_error_px, num_behind_camera,
// image_marker_ratio. Table images.
void AddMetrics(const ModelMetrics& metrics, MetricsReport* report);

// scale_m_per_unit, scale_sigma_percent, scale_spread_percent, num_scale_markers.
void AddMetrics(const ScaleEstimate& scale, MetricsReport* report);

// Tables parts and part_pairs; the pairs' sigmas are those of `covariance`.
void AddMetrics(const std::vector<PartPlane>& planes, MetricsReport* report,
                const PointCovariance* covariance = nullptr);

// adjacent_distance_error_mm, adjacent_distance_deviation_percent. Table adjacent_distances.
void AddMetrics(const std::vector<AdjacentDistance>& distances, MetricsReport* report);

// corners_above_4_sigma_percent, corner_sigma_factor, correlation_factor.
void AddMetrics(const AdjustmentUncertainty& uncertainty, MetricsReport* report);

// num_points, distance_mm, scale, scale_error_percent, distance_after_scaling_mm. Table
// reference_markers.
void AddMetrics(const ShapeComparison& comparison, MetricsReport* report);

}  // namespace velamap
