#include "exporters/compare/comparison_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

Statistics InMm(const Statistics& in_m) { return Scaled(kMmPerM, in_m); }

void AddVector(const std::string& name, const Eigen::Vector3d& value_m, Metrics* metrics) {
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    metrics->push_back({fmt::format("{}_{}_mm", name, axes[i]), kMmPerM * value_m[i]});
  }
}

void AddAlignment(const Alignment& alignment, MetricsReport* report) {
  Metrics& metrics = report->metrics;
  metrics.push_back({"alignment", AlignmentMethodName(alignment.method)});
  metrics.push_back({"alignment_by", alignment.description});
  AddTexts("alignment_note", alignment.notes, &metrics);
  if (alignment.method != AlignmentMethod::kNone) {
    metrics.push_back({"alignment_residual_mm", InMm(alignment.residual_m)});
  }
  const Rigid3& pose = alignment.reference_from_shape;
  metrics.push_back({"alignment_turn_deg",
                     kDegPerRad * pose.rotation.angularDistance(Eigen::Quaterniond::Identity())});
  MetricTable table{"reference_from_shape", false, {}};
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  table.rows.push_back({{"qw", q.w()},
                        {"qx", q.x()},
                        {"qy", q.y()},
                        {"qz", q.z()},
                        {"tx_m", t.x()},
                        {"ty_m", t.y()},
                        {"tz_m", t.z()}});
  report->tables.push_back(std::move(table));
}

MetricTable GroupTable(const char* name, const std::vector<DeviationGroup>& groups,
                       bool has_sigma) {
  MetricTable table{name, true, {}};
  for (const DeviationGroup& group : groups) {
    Metrics row = {{"part", group.part}};
    if (!group.line.empty()) row.push_back({"line", group.line});
    row.push_back({"distance_mm", InMm(group.distance_m)});
    if (has_sigma) row.push_back({"num_significant", group.num_significant});
    table.rows.push_back(std::move(row));
  }
  return table;
}

Metrics MarkerRow(const MarkerDeviation& marker, bool is_against_surface) {
  Metrics row = {{"marker_id", marker.marker_id}, {"part", marker.part}};
  if (is_against_surface) {
    row.push_back({"is_over_surface", marker.is_over_surface ? 1 : 0});
    row.push_back({"beside_mm", kMmPerM * marker.beside_m});
  }
  if (marker.is_over_surface) {
    row.push_back({"distance_mm", kMmPerM * marker.distance_m});
    if (marker.sigma_m) row.push_back({"sigma_mm", kMmPerM * *marker.sigma_m});
    if (marker.significance) row.push_back({"significance", *marker.significance});
  }
  if (marker.difference_m) AddVector("difference", *marker.difference_m, &row);
  if (marker.difference_sigma_m) AddVector("difference_sigma", *marker.difference_sigma_m, &row);
  const Eigen::Vector3d& x_m = marker.x_in_reference_m;
  row.insert(row.end(), {{"x_m", x_m.x()}, {"y_m", x_m.y()}, {"z_m", x_m.z()}});
  return row;
}

void DropRoundingErrors(double* value) {
  constexpr double kLargest = 1e-9;
  if (std::abs(*value) < kLargest) *value = 0.0;
}

void DropRoundingErrors(Metric* metric) {
  if (auto* value = std::get_if<double>(&metric->value)) DropRoundingErrors(value);
  if (auto* s = std::get_if<Statistics>(&metric->value)) {
    for (double* value :
         {&s->mean, &s->standard_deviation, &s->median, &s->min, &s->max, &s->rms}) {
      DropRoundingErrors(value);
    }
  }
}

}  // namespace

void AddMetrics(const ShapeDeviation& deviation, MetricsReport* report) {
  Metrics& metrics = report->metrics;
  if (deviation.doubt) {
    const char* level = deviation.doubt->is_bad ? "bad" : "check";
    metrics.push_back({"verdict", level});
    metrics.push_back({"verdict_reason", fmt::format("{}; {}", level, deviation.doubt->reason)});
  }
  AddAlignment(deviation.alignment, report);
  const bool is_against_surface = !deviation.scale.has_value();
  const bool has_sigma = deviation.num_with_sigma > 0;
  if (deviation.scale) {
    metrics.push_back({"scale_difference_percent", 100.0 * (*deviation.scale - 1.0)});
  }
  metrics.push_back({"num_markers", static_cast<int>(deviation.markers.size())});
  if (is_against_surface) {
    metrics.push_back({"num_beyond_edge", deviation.num_beyond_edge});
    metrics.push_back({"num_beside_surface", deviation.num_beside});
    metrics.push_back({"beside_surface_ids", MarkersBeside(deviation)});
  } else {
    metrics.push_back({"only_in_shape_ids", deviation.only_in_shape});
    metrics.push_back({"only_in_reference_ids", deviation.only_in_reference});
  }
  if (deviation.surface_sigma_m > 0) {
    metrics.push_back({"reference_sigma_mm", kMmPerM * deviation.surface_sigma_m});
  }
  metrics.push_back({"distance_mm", InMm(deviation.distance_m)});
  if (!is_against_surface) metrics.push_back({"difference_mm", InMm(deviation.difference_m)});
  if (has_sigma) {
    metrics.push_back({"num_with_sigma", deviation.num_with_sigma});
    metrics.push_back({"num_significant", deviation.num_significant});
  }
  report->tables.push_back(GroupTable("parts", deviation.parts, has_sigma));
  report->tables.push_back(GroupTable("lines", deviation.lines, has_sigma));
  MetricTable markers{"markers", false, {}};
  for (const MarkerDeviation& marker : deviation.markers) {
    markers.rows.push_back(MarkerRow(marker, is_against_surface));
  }
  report->tables.push_back(std::move(markers));
}

void AddMetrics(const SurfaceComparison& comparison, MetricsReport* report) {
  AddTexts("surface_note", comparison.notes, &report->metrics);
  MetricTable table{"surfaces", true, {}};
  for (const SurfaceDeviation& part : comparison.parts) {
    table.rows.push_back({{"part", part.part}, {"surface_distance_mm", InMm(part.statistics_m)}});
  }
  report->tables.push_back(std::move(table));
}

void AddMetrics(const SectionComparison& comparison, MetricsReport* report) {
  const auto& differences = comparison.differences;
  const auto num_significant = std::count_if(differences.begin(), differences.end(),
                                             [](const auto& d) { return d.IsSignificant(); });
  report->metrics.push_back({"section_frame", comparison.frame_name});
  report->metrics.push_back({"num_significant_section_numbers", static_cast<int>(num_significant)});
  AddTexts("section_note", comparison.notes, &report->metrics);
  MetricTable table{"section_differences", true, {}};
  for (const SectionDifference& d : differences) {
    Metrics row = {{"part", d.part},   {"section", d.section},     {"number", d.number},
                   {"value", d.value}, {"reference", d.reference}, {"difference", d.Difference()}};
    if (d.sigma) row.push_back({"sigma", *d.sigma});
    if (d.significance) row.push_back({"significance", *d.significance});
    row.push_back({"is_significant", d.IsSignificant() ? 1 : 0});
    table.rows.push_back(std::move(row));
  }
  report->tables.push_back(std::move(table));
}

void DropRoundingErrors(MetricsReport* report) {
  for (Metric& metric : report->metrics) DropRoundingErrors(&metric);
  for (MetricTable& table : report->tables) {
    for (Metrics& row : table.rows) {
      for (Metric& metric : row) DropRoundingErrors(&metric);
    }
  }
}

}  // namespace velamap
