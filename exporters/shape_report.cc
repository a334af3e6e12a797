#include "exporters/shape_report.h"

#include <cmath>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

// Adds a known sigma.
void AddSigma(const char* key, const std::optional<double>& sigma, Metrics* metrics,
              double factor = 1.0) {
  if (sigma) metrics->push_back({key, factor * *sigma});
}

void Append(const Metrics& metrics, MetricsReport* report) {
  report->metrics.insert(report->metrics.end(), metrics.begin(), metrics.end());
}

}  // namespace

void AddMetrics(const ShapeFrame& frame, MetricsReport* report) {
  Append({{"frame_name", frame.name}, {"frame_description", frame.description}}, report);
  AddTexts("frame_reasons", frame.reasons, &report->metrics);
}

void AddMetrics(const FreeformShape& freeform, MetricsReport* report) {
  AddTexts("freeform_notes", freeform.notes, &report->metrics);
  if (freeform.surfaces.empty()) return;
  MetricTable table{"freeform_surfaces", true, {}};
  for (const PartSurface& part : freeform.surfaces) {
    const FreeformSurface& surface = part.surface;
    table.rows.push_back(
        {{"part", part.part}, {"file", part.file_stem}, {"area_m2", surface.area_m2}});
    if (surface.volume_m3) table.rows.back().push_back({"volume_m3", *surface.volume_m3});
    table.rows.back().push_back({"surface_sigma_mm", kMmPerM * surface.rms_sigma_m});
    table.rows.back().push_back({"distance_mm", Scaled(kMmPerM, surface.distance_m)});
  }
  report->tables.push_back(std::move(table));
}

void AddMetrics(const ShapeMetrics& metrics, MetricsReport* report) {
  Append({{"num_markers", metrics.num_markers}}, report);
  if (metrics.num_layout_markers) {
    Append({{"num_layout_markers", *metrics.num_layout_markers},
            {"reconstruction_ratio", metrics.reconstruction_ratio.value()},
            {"missing_marker_ids", metrics.missing_marker_ids}},
           report);
  }
  if (!metrics.other_marker_ids.empty()) {
    Append({{"other_marker_ids", metrics.other_marker_ids}}, report);
  }
  if (metrics.num_sail_markers) {
    Append({{"num_sail_markers", *metrics.num_sail_markers},
            {"sail_reconstruction_ratio", metrics.sail_reconstruction_ratio.value()}},
           report);
  }
  Append({{"area_error_mm2", metrics.area_error_mm2},
          {"area_error_percent", metrics.area_error_percent},
          {"side_error_mm", metrics.side_error_mm}},
         report);
  AddSigma("area_sigma_mm2", metrics.area_sigma_mm2, &report->metrics);
  AddSigma("side_sigma_mm", metrics.side_sigma_mm, &report->metrics);
  MetricTable table{"markers", false, {}};
  for (const MarkerMetrics& marker : metrics.markers) {
    table.rows.push_back({{"marker_id", marker.marker_id},
                          {"part", marker.part},
                          {"area_error_mm2", marker.area_error_mm2},
                          {"area_error_percent", marker.area_error_percent},
                          {"side_error_mm", marker.side_error_mm},
                          {"mean_side_mm", marker.mean_side_mm}});
    AddSigma("area_sigma_mm2", marker.area_sigma_mm2, &table.rows.back());
    AddSigma("mean_side_sigma_mm", marker.mean_side_sigma_mm, &table.rows.back());
  }
  report->tables.push_back(std::move(table));
}

void AddMetrics(const ModelMetrics& metrics, MetricsReport* report) {
  Append({{"central_image_name", metrics.central_image_name},
          {"central_reprojection_error_px", metrics.central_error_px},
          {"reprojection_error_px", metrics.error_px},
          {"num_behind_camera", metrics.num_behind_camera}},
         report);
  if (metrics.marker_ratio.count > 0)
    Append({{"image_marker_ratio", metrics.marker_ratio}}, report);
  MetricTable table{"images", true, {}};
  for (const ImageMetrics& image : metrics.images) {
    Metrics row = {{"image_name", image.image_name}, {"num_markers", image.num_markers}};
    if (image.marker_ratio) row.push_back({"marker_ratio", *image.marker_ratio});
    row.push_back({"reprojection_error_px", image.error_px});
    table.rows.push_back(std::move(row));
  }
  report->tables.push_back(std::move(table));
}

void AddMetrics(const ScaleEstimate& scale, MetricsReport* report) {
  Append({{"scale_m_per_unit", scale.m_per_unit}}, report);
  AddSigma("scale_sigma_percent", scale.relative_sigma, &report->metrics, 100.0);
  if (scale.print_sigma > 0) {
    Append({{"print_scale_sigma_percent", 100.0 * scale.print_sigma}}, report);
  }
  Append({{"scale_spread_percent", 100.0 * scale.relative_spread},
          {"num_scale_markers", scale.num_markers}},
         report);
}

void AddMetrics(const std::vector<PartPlane>& planes, MetricsReport* report,
                const PointCovariance* covariance) {
  MetricTable parts{"parts", true, {}};
  for (const PartPlane& plane : planes) {
    parts.rows.push_back({{"part", plane.part},
                          {"num_markers", plane.num_markers},
                          {"plane_error_mm", plane.center_distance_mm},
                          {"corner_plane_error_mm", plane.corner_distance_mm},
                          {"normal_spread_deg", plane.normal_spread_deg},
                          {"tangent_spread_deg", plane.tangent_spread_deg}});
    AddSigma("plane_error_sigma_mm", plane.center_distance_sigma_mm, &parts.rows.back());
  }
  MetricTable pairs{"part_pairs", true, {}};
  for (const PlanePair& pair : ComparePlanes(planes, covariance)) {
    Metrics row = {{"part1", pair.part1}, {"part2", pair.part2}, {"angle_deg", pair.angle_deg}};
    AddSigma("angle_sigma_deg", pair.angle_sigma_deg, &row);
    if (pair.distance_mm > 0) row.push_back({"distance_mm", pair.distance_mm});
    AddSigma("distance_sigma_mm", pair.distance_sigma_mm, &row);
    pairs.rows.push_back(std::move(row));
  }
  report->tables.push_back(std::move(parts));
  report->tables.push_back(std::move(pairs));
}

void AddMetrics(const std::vector<AdjacentDistance>& distances, MetricsReport* report) {
  std::vector<double> errors_mm, deviations_percent;
  MetricTable table{"adjacent_distances", false, {}};
  for (const AdjacentDistance& pair : distances) {
    const double deviation_m = pair.distance_m - pair.reference_distance_m;
    errors_mm.push_back(std::abs(deviation_m) * kMmPerM);
    if (pair.reference_distance_m > 0) {
      deviations_percent.push_back(100.0 * deviation_m / pair.reference_distance_m);
    }
    table.rows.push_back({{"marker_id1", pair.marker_id1},
                          {"marker_id2", pair.marker_id2},
                          {"distance_mm", pair.distance_m * kMmPerM},
                          {"reference_distance_mm", pair.reference_distance_m * kMmPerM}});
    AddSigma("distance_sigma_mm", pair.sigma_m, &table.rows.back(), kMmPerM);
  }
  Append(
      {{"adjacent_distance_error_mm", ComputeStatistics(std::move(errors_mm))},
       {"adjacent_distance_deviation_percent", ComputeStatistics(std::move(deviations_percent))}},
      report);
  report->tables.push_back(std::move(table));
}

void AddMetrics(const AdjustmentUncertainty& uncertainty, MetricsReport* report) {
  Append({{"corners_above_4_sigma_percent", 100.0 * uncertainty.share_above_4_sigma},
          {"corner_sigma_factor", std::sqrt(uncertainty.variance_factor)},
          {"correlation_factor", uncertainty.correlation_factor}},
         report);
  if (uncertainty.rolling_shutter_sigma_s > 0) {
    AddEstimate("rolling_shutter", "ms",
                Estimate{uncertainty.rolling_shutter_s, uncertainty.rolling_shutter_sigma_s}, 1e3,
                &report->metrics);
  }
}

void AddMetrics(const ReferenceMetrics& comparison, MetricsReport* report) {
  Append({{"num_points", comparison.num_points},
          {"distance_mm", Scaled(kMmPerM, comparison.distance_m)}},
         report);
  AddSigma("distance_sigma_mm", comparison.distance_sigma_m, &report->metrics, kMmPerM);
  Append({{"scale", comparison.scale},
          {"scale_error_percent", 100.0 * (comparison.scale - 1.0)},
          {"distance_after_scaling_mm", Scaled(kMmPerM, comparison.distance_after_scaling_m)}},
         report);
  AddSigma("distance_after_scaling_sigma_mm", comparison.distance_after_scaling_sigma_m,
           &report->metrics, kMmPerM);
  MetricTable table{"reference_markers", false, {}};
  for (const MarkerDistance& marker : comparison.markers) {
    table.rows.push_back(
        {{"marker_id", marker.marker_id},
         {"num_corners", marker.num_corners},
         {"distance_mm", marker.distance_m * kMmPerM},
         {"distance_after_scaling_mm", marker.distance_after_scaling_m * kMmPerM}});
  }
  report->tables.push_back(std::move(table));
}

}  // namespace velamap
