#include "exporters/scale/scale_audit_report.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

std::vector<const MarkerScale*> DisagreeingMarkers(const ScaleAudit& audit) {
  std::vector<const MarkerScale*> markers;
  for (const MarkerScale& marker : audit.markers) {
    if (marker.Disagrees()) markers.push_back(&marker);
  }
  return markers;
}

Metrics MarkerRow(const MarkerScale& marker) {
  Metrics row = {{"marker_id", marker.marker_id},
                 {"part", marker.part},
                 {"layout_length_mm", marker.length_m * kMmPerM},
                 {"side_mm", marker.side_m * kMmPerM}};
  AddEstimate("deviation", "percent", Estimate{marker.deviation, marker.sigma}, 100.0, &row);
  row.push_back({"sigmas_off", marker.sigmas_off});
  if (marker.side_px) row.push_back({"side_px", *marker.side_px});
  return row;
}

Metrics GroupRow(Metric name, const GroupScale& group) {
  Metrics row = {std::move(name), {"num_markers", group.num_markers}};
  AddEstimate("deviation_from_others", "percent", Estimate{group.deviation, group.sigma}, 100.0,
              &row);
  return row;
}

Metrics DistanceRow(const CheckedDistance& checked) {
  const KnownDistance& known = checked.known;
  Metrics row = {{"from", PointName(known.marker_id1, known.corner1)},
                 {"to", PointName(known.marker_id2, known.corner2)},
                 {"use", std::string(known.is_scale_bar ? "scale" : "check")},
                 {"measured_mm", known.length_m * kMmPerM},
                 {"measured_sigma_mm", known.sigma_m * kMmPerM}};
  if (!checked.distance_m) return row;
  row.push_back({"distance_mm", *checked.distance_m * kMmPerM});
  if (checked.sigma_m) row.push_back({"distance_sigma_mm", *checked.sigma_m * kMmPerM});
  row.push_back({"difference_mm", (*checked.distance_m - known.length_m) * kMmPerM});
  row.push_back({"difference_sigma_mm", checked.DifferenceSigma() * kMmPerM});
  row.push_back({"difference_in_sigmas", checked.DifferenceInSigmas()});
  return row;
}

void AddFigures(const ScaleAudit& audit, Metrics* metrics) {
  if (!audit.markers.empty()) {
    AddEstimate("marker_scale_deviation", "percent",
                Estimate{audit.deviation, audit.deviation_sigma}, 100.0, metrics);
    metrics->push_back({"marker_scale_spread_percent", 100.0 * audit.marker_spread});
    std::vector<int> ids;
    for (const MarkerScale* marker : DisagreeingMarkers(audit)) ids.push_back(marker->marker_id);
    metrics->push_back({"num_disagreeing_markers", static_cast<int>(ids.size())});
    metrics->push_back({"disagreeing_marker_ids", ids});
  }
  if (audit.x_over_y)
    AddEstimate("x_over_y", "percent", Estimate{*audit.x_over_y - 1, audit.x_over_y_sigma}, 100.0,
                metrics);
  metrics->push_back({"spread_note", audit.spread.note});
  AddEstimate("print_spread", "um", audit.spread.print_um, 1.0, metrics);
  AddEstimate("image_spread", "px", audit.spread.image_px, 1.0, metrics);
  AddEstimate("apparent_inset", "px", audit.apparent_inset_px, 1.0, metrics);
  if (audit.distance_deviation) {
    AddEstimate("known_distance_deviation", "percent",
                Estimate{*audit.distance_deviation, audit.distance_deviation_sigma}, 100.0,
                metrics);
  }
}

std::string PercentText(double value, const std::optional<double>& sigma) {
  std::string text = fmt::format("{:+.3f}", 100.0 * value);
  if (sigma) text += fmt::format(" +- {:.3f}", 100.0 * *sigma);
  return text + " %";
}

// The difference from what `sigmas_off` of the marker compares it with, as a fraction: the mean of
// all markers, or of those of its part where parts disagree.
double DifferenceFromOthers(const MarkerScale& marker, const ScaleAudit& audit) {
  if (!audit.parts_disagree) return (1 + marker.deviation) / (1 + audit.deviation) - 1;
  return std::expm1(marker.sigmas_off *
                    std::hypot(marker.sigma.value_or(0.0), audit.marker_spread));
}

void PrintDisagreeingMarkers(const ScaleAudit& audit, std::ostream& out) {
  constexpr std::size_t kMaxMarkers = 5;
  std::vector<const MarkerScale*> markers = DisagreeingMarkers(audit);
  std::stable_sort(markers.begin(), markers.end(), [](const MarkerScale* a, const MarkerScale* b) {
    return std::abs(a->sigmas_off) > std::abs(b->sigmas_off);
  });
  out << fmt::format("scale_disagreeing_markers: {} of {}", markers.size(), audit.markers.size());
  const std::size_t num_named = std::min(markers.size(), kMaxMarkers);
  for (std::size_t i = 0; i < num_named; ++i) {
    const std::string_view others =
        audit.parts_disagree ? "; against those of their part:" : "; against the others:";
    out << fmt::format("{} {} by {:+.2f} %", i == 0 ? others : ",", markers[i]->marker_id,
                       100.0 * DifferenceFromOthers(*markers[i], audit));
  }
  out << (markers.size() > kMaxMarkers ? ", ...\n" : "\n");
}

void PrintParts(const ScaleAudit& audit, std::ostream& out) {
  const auto size = [](const GroupScale& part) {
    return std::abs(part.deviation) / part.sigma.value_or(1.0);
  };
  const auto worst =
      std::max_element(audit.parts.begin(), audit.parts.end(),
                       [&](const GroupScale& a, const GroupScale& b) { return size(a) < size(b); });
  if (worst == audit.parts.end()) return;
  out << fmt::format("scale_of_part_against_others: {} {} (largest of {} parts{})\n",
                     worst->part.empty() ? "without a part" : worst->part,
                     PercentText(worst->deviation, worst->sigma), audit.parts.size(),
                     audit.parts_disagree ? ", which disagree" : "");
}

void PrintDistances(const ScaleAudit& audit, std::ostream& out) {
  if (audit.distances.empty()) return;
  out << fmt::format("known_distances: {} of {} reconstructed", NumDistancesFound(audit),
                     audit.distances.size());
  if (audit.distance_deviation) {
    out << ", checks off by "
        << PercentText(*audit.distance_deviation, audit.distance_deviation_sigma);
  }
  const CheckedDistance* worst = WorstDistance(audit);
  if (worst != nullptr) out << ", worst " << ShortText(*worst);
  out << '\n';
}

std::string NameOf(const KnownDistance& known) {
  return fmt::format("{}-{}", PointName(known.marker_id1, known.corner1),
                     PointName(known.marker_id2, known.corner2));
}

// One warning for all distances that were to give the scale and could not.
std::vector<std::string> UnusedBarWarnings(const ScaleAudit& audit) {
  std::vector<std::string> names;
  for (const CheckedDistance& checked : audit.distances) {
    if (checked.distance_m && checked.known.is_scale_bar && checked.IsCheck()) {
      names.push_back(NameOf(checked.known));
    }
  }
  if (names.empty()) return {};
  return {fmt::format(
      "the distances with use: scale ({}) are only compared with the shape, because only the "
      "marker-aware adjustment uses them: adjust the model with "
      "velamap bundle_adjuster --backend markers or both, or give that option to "
      "automatic_reconstructor",
      fmt::join(names, ", "))};
}

}  // namespace

std::string ShortText(const CheckedDistance& checked) {
  return fmt::format("{} {:+.2f} mm ({:+.1f} sigmas)", NameOf(checked.known),
                     (*checked.distance_m - checked.known.length_m) * kMmPerM,
                     checked.DifferenceInSigmas());
}

std::vector<const CheckedDistance*> FailedChecks(const ScaleAudit& audit) {
  std::vector<const CheckedDistance*> failed;
  for (const CheckedDistance& checked : audit.distances) {
    if (checked.FailsAsCheck()) failed.push_back(&checked);
  }
  return failed;
}

int NumChecks(const ScaleAudit& audit) {
  return static_cast<int>(std::count_if(
      audit.distances.begin(), audit.distances.end(),
      [](const CheckedDistance& checked) { return checked.distance_m && checked.IsCheck(); }));
}

int NumDistancesFound(const ScaleAudit& audit) {
  return static_cast<int>(
      std::count_if(audit.distances.begin(), audit.distances.end(),
                    [](const CheckedDistance& checked) { return checked.distance_m.has_value(); }));
}

const CheckedDistance* WorstDistance(const ScaleAudit& audit) {
  const auto badness = [](const CheckedDistance& checked) {
    return std::make_pair(checked.FailsAsCheck(), std::abs(checked.DifferenceInSigmas()));
  };
  const CheckedDistance* worst = nullptr;
  for (const CheckedDistance& checked : audit.distances) {
    if (!checked.distance_m) continue;
    if (worst == nullptr || badness(checked) > badness(*worst)) worst = &checked;
  }
  return worst;
}

std::vector<std::string> ScaleWarnings(const ScaleAudit& audit) {
  std::vector<std::string> warnings = UnusedBarWarnings(audit);
  for (const CheckedDistance* checked : FailedChecks(audit)) {
    const KnownDistance& known = checked->known;
    warnings.push_back(fmt::format(
        "the distance from marker {} to marker {} was measured as {:.5g} +- {:.2g} m, but is "
        "{:.5g}{} m in the shape: off by {:+.1f} mm, {:.1f} sigmas of both; find out which is "
        "wrong before using the shape",
        PointName(known.marker_id1, known.corner1), PointName(known.marker_id2, known.corner2),
        known.length_m, known.sigma_m, *checked->distance_m,
        checked->sigma_m ? fmt::format(" +- {:.2g}", *checked->sigma_m) : "",
        (*checked->distance_m - known.length_m) * kMmPerM,
        std::abs(checked->DifferenceInSigmas())));
  }
  return warnings;
}

void AddMetrics(const ScaleAudit& audit, MetricsReport* report) {
  AddFigures(audit, &report->metrics);
  MetricTable histogram{"scale_histogram", true, {}}, disagreeing{"disagreeing_markers", true, {}},
      markers{"scale_markers", false, {}}, parts{"scale_parts", true, {}},
      sizes{"scale_sizes", true, {}}, distances{"known_distances", true, {}};
  for (const HistogramBin& bin : audit.histogram) {
    histogram.rows.push_back({{"from_percent", 100.0 * bin.from},
                              {"to_percent", 100.0 * bin.to},
                              {"num_markers", bin.num_markers}});
  }
  for (const MarkerScale* marker : DisagreeingMarkers(audit)) {
    disagreeing.rows.push_back(MarkerRow(*marker));
  }
  for (const MarkerScale& marker : audit.markers) markers.rows.push_back(MarkerRow(marker));
  for (const GroupScale& part : audit.parts) {
    parts.rows.push_back(GroupRow({"part", part.part}, part));
  }
  for (const GroupScale& size : audit.sizes) {
    sizes.rows.push_back(GroupRow({"layout_length_mm", size.length_m * kMmPerM}, size));
  }
  for (const CheckedDistance& checked : audit.distances) {
    distances.rows.push_back(DistanceRow(checked));
  }
  for (MetricTable* table : {&histogram, &disagreeing, &markers, &parts, &sizes, &distances}) {
    report->tables.push_back(std::move(*table));
  }
}

void PrintScaleAudit(const ScaleEstimate& scale, const ScaleAudit& audit, std::ostream& out) {
  if (scale.relative_sigma) {
    out << fmt::format("scale_sigma: {:.4f} % ({} markers, which scatter by {:.3f} %)\n",
                       100.0 * *scale.relative_sigma, scale.num_markers,
                       100.0 * audit.marker_spread);
  }
  if (!audit.markers.empty()) PrintDisagreeingMarkers(audit, out);
  PrintParts(audit, out);
  PrintDistances(audit, out);
}

}  // namespace velamap
