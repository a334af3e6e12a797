#include "exporters/metrics_text.h"

#include <ostream>
#include <string>

#include <fmt/format.h>

namespace velamap {
namespace {

constexpr double kMmPerM = 1e3;

void PrintStatistics(const std::string& key, const Statistics& statistics, double factor,
                     std::ostream& out) {
  out << fmt::format("{}_count: {}\n", key, statistics.count);
  if (statistics.count == 0) return;
  const auto print = [&](const char* name, double value) {
    out << fmt::format("{}_{}: {:.6g}\n", key, name, factor * value);
  };
  print("mean", statistics.mean);
  print("std", statistics.standard_deviation);
  print("median", statistics.median);
  print("min", statistics.min);
  print("max", statistics.max);
  print("rms", statistics.rms);
}

}  // namespace

void PrintMetrics(const ShapeMetrics& metrics, std::ostream& out) {
  out << fmt::format("num_markers: {}\n", metrics.num_markers);
  if (metrics.num_layout_markers) {
    out << fmt::format("num_layout_markers: {}\n", *metrics.num_layout_markers);
    out << fmt::format("reconstruction_ratio: {:.6g}\n", metrics.reconstruction_ratio.value());
    out << fmt::format("missing_marker_ids: {}\n",
                       metrics.missing_marker_ids.empty()
                           ? "none"
                           : fmt::format("{}", fmt::join(metrics.missing_marker_ids, " ")));
  }
  PrintStatistics("area_error_mm2", metrics.area_error_mm2, 1.0, out);
  PrintStatistics("area_error_percent", metrics.area_error_percent, 1.0, out);
  PrintStatistics("side_error_mm", metrics.side_error_mm, 1.0, out);
}

void PrintMetrics(const ShapeComparison& comparison, std::ostream& out) {
  out << fmt::format("num_points: {}\n", comparison.num_points);
  PrintStatistics("distance_mm", comparison.distance_m, kMmPerM, out);
  out << fmt::format("scale: {:.9g}\n", comparison.scale);
  out << fmt::format("scale_error_percent: {:.6g}\n", 100.0 * (comparison.scale - 1.0));
  PrintStatistics("distance_after_scaling_mm", comparison.distance_after_scaling_m, kMmPerM, out);
}

}  // namespace velamap
