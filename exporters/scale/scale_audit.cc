#include "exporters/scale/scale_audit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "exporters/scale/marker_sides.h"
#include "exporters/scale/metric_shape.h"
#include "exporters/scale/robust_fit.h"
#include "exporters/scale/round_number.h"
#include "exporters/shape/shape_metrics.h"
#include "importer/base/statistics.h"
#include "reconstruct/problem/marker_chords.h"
#include "reconstruct/problem/marker_state.h"
#include "reconstruct/sizes/marker_curvature.h"

namespace velamap {
namespace {

// The mean of fewer markers is no evidence about their part.
constexpr int kMinMarkersOfPart = 3;

std::vector<MeasuredMarkerSides> MeasureForShape(const MarkerShape& shape, const Layout& layout,
                                                 const Model* model,
                                                 const AdjustmentUncertainty* uncertainty) {
  if (model == nullptr) return MeasureSides(shape);
  const double units_per_m = ComputeReferenceMetrics(ShapeFromModel(*model, layout), shape).scale;
  std::vector<MeasuredMarkerSides> markers;
  if (uncertainty == nullptr) {
    markers = MeasureSides(*model, layout);
  } else {
    Model intersected = *model;
    RetriangulateCorners(uncertainty->apparent_inset_px, &intersected);
    markers = MeasureSides(intersected, layout);
  }
  for (MeasuredMarkerSides& marker : markers) {
    for (double& side : marker.sides) side /= units_per_m;
  }
  return markers;
}

// Sides along the bend instead of their chords. `model` is metric.
void MeasureAlongBends(const Model& model, const Layout& layout,
                       std::vector<MeasuredMarkerSides>* markers) {
  MarkerState state = MakeMarkerState(model, layout);
  SetChords(&state);
  std::map<int, MarkerChords> chords;
  for (const MarkerBlock& marker : state.markers) chords[marker.marker_id] = marker.chords;
  for (MeasuredMarkerSides& marker : *markers) {
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      marker.sides[i] /= chords[marker.marker_id].side_ratios[i];
    }
  }
}

// Markers that degenerate to a point have no scale.
void RemoveDegenerateMarkers(std::vector<MeasuredMarkerSides>* markers) {
  const auto is_point = [](const MeasuredMarkerSides& marker) {
    return *std::min_element(marker.sides.begin(), marker.sides.end()) == 0;
  };
  markers->erase(std::remove_if(markers->begin(), markers->end(), is_point), markers->end());
}

std::vector<MarkerScale> ScalesOf(const std::vector<MeasuredMarkerSides>& measured,
                                  const Layout& layout) {
  std::vector<MarkerScale> markers;
  for (const MeasuredMarkerSides& sides : measured) {
    MarkerScale marker;
    marker.marker_id = sides.marker_id;
    marker.part = sides.part;
    marker.length_m = MarkerLength(layout, sides.marker_id);
    marker.side_m = MeanSide(sides.sides);
    marker.deviation = marker.length_m / marker.side_m - 1.0;
    marker.sigma = sides.mean_sigma;
    marker.side_px = sides.side_px;
    markers.push_back(marker);
  }
  return markers;
}

// Averages logarithms, so that half and twice the size deviate equally.
RobustMean MeanScale(const std::vector<const MarkerScale*>& markers, double marker_spread) {
  std::vector<double> values, sigmas;
  for (const MarkerScale* marker : markers) {
    values.push_back(std::log1p(marker->deviation));
    sigmas.push_back(std::hypot(marker->sigma.value_or(0.0), marker_spread));
  }
  return FitMeanRobustly(values, sigmas);
}

void CompareMarkersWithMean(ScaleAudit* audit) {
  std::vector<const MarkerScale*> all;
  for (const MarkerScale& marker : audit->markers) all.push_back(&marker);
  const RobustMean mean = MeanScale(all, 0.0);
  audit->deviation = std::expm1(mean.mean);
  audit->deviation_sigma = mean.sigma;
  audit->marker_spread = mean.excess_sigma;
  for (std::size_t i = 0; i < all.size(); ++i) audit->markers[i].sigmas_off = mean.sigmas_off[i];
}

// Makes bins of about half a robust sigma, one of them around 0, within ten bins of the median. The
// first and the last bin take everything beyond.
std::vector<HistogramBin> MakeDeviationHistogram(const std::vector<MarkerScale>& markers) {
  constexpr double kLeastWidth = 1e-6;
  constexpr int kMaxBinsASide = 10;
  std::vector<double> deviations;
  for (const MarkerScale& marker : markers) deviations.push_back(marker.deviation);
  const double width = RoundUp(std::max(0.5 * RobustSigma(deviations), kLeastWidth));
  const double median_bin = std::round(Median(deviations) / width);
  const auto bin_of = [&](double deviation) {
    return std::clamp(std::round(deviation / width), median_bin - kMaxBinsASide,
                      median_bin + kMaxBinsASide);
  };
  const auto [least, greatest] = std::minmax_element(deviations.begin(), deviations.end());
  const double first = bin_of(*least);
  std::vector<HistogramBin> bins(static_cast<std::size_t>(bin_of(*greatest) - first) + 1);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].from = width * (first + static_cast<double>(i) - 0.5);
    bins[i].to = width * (first + static_cast<double>(i) + 0.5);
  }
  for (const double deviation : deviations) {
    ++bins[static_cast<std::size_t>(bin_of(deviation) - first)].num_markers;
  }
  bins.front().from = std::min(bins.front().from, *least);
  bins.back().to = std::max(bins.back().to, *greatest);
  return bins;
}

void CompareWidthAndHeight(const std::vector<MeasuredMarkerSides>& measured, ScaleAudit* audit) {
  std::vector<double> values, sigmas;
  for (const MeasuredMarkerSides& marker : measured) {
    values.push_back(std::log(marker.HorizontalOverVertical()));
    sigmas.push_back(marker.ratio_sigma.value_or(0.0));
  }
  const RobustMean mean = FitMeanRobustly(values, sigmas);
  audit->x_over_y = std::exp(mean.mean);
  audit->x_over_y_sigma = mean.sigma;
}

// Compares every group with all other markers. Empty if all markers are in one group.
template <typename Key>
std::map<Key, GroupScale> CompareGroups(const ScaleAudit& audit,
                                        const std::function<Key(const MarkerScale&)>& key_of) {
  std::map<Key, std::vector<const MarkerScale*>> groups;
  for (const MarkerScale& marker : audit.markers) groups[key_of(marker)].push_back(&marker);
  std::map<Key, GroupScale> scales;
  if (groups.size() < 2) return scales;
  for (const auto& [key, group] : groups) {
    std::vector<const MarkerScale*> others;
    for (const auto& [other_key, other] : groups) {
      if (other_key != key) others.insert(others.end(), other.begin(), other.end());
    }
    // The scatter of all markers, because two markers of a group can agree by chance.
    const RobustMean own = MeanScale(group, audit.marker_spread);
    const RobustMean rest = MeanScale(others, audit.marker_spread);
    GroupScale& scale = scales[key];
    scale.num_markers = static_cast<int>(group.size());
    scale.deviation = std::expm1(own.mean - rest.mean);
    if (own.sigma && rest.sigma) scale.sigma = std::hypot(*own.sigma, *rest.sigma);
  }
  return scales;
}

void CompareParts(ScaleAudit* audit) {
  audit->parts.clear();
  const auto part_of = [](const MarkerScale& marker) { return marker.part; };
  for (auto& [part, scale] : CompareGroups<std::string>(*audit, part_of)) {
    audit->parts.push_back(scale);
    audit->parts.back().part = part;
  }
}

// Whether one of the parts is off by more than its sigma explains.
bool PartsDisagree(const std::vector<GroupScale>& parts) {
  return std::any_of(parts.begin(), parts.end(), [](const GroupScale& part) {
    return part.sigma && part.num_markers >= kMinMarkersOfPart &&
           std::abs(part.deviation) > kMaxRobustSigmas * *part.sigma;
  });
}

// Sets the spread of the markers around the means of their parts, and how far each is off. Parts of
// few markers are compared with all.
void CompareMarkersWithTheirParts(ScaleAudit* audit) {
  std::map<std::string, std::vector<const MarkerScale*>> of_part;
  for (const MarkerScale& marker : audit->markers) of_part[marker.part].push_back(&marker);
  std::map<std::string, double> means;
  for (const auto& [part, markers] : of_part) {
    const bool has_mean = markers.size() >= kMinMarkersOfPart;
    means[part] = has_mean ? MeanScale(markers, 0.0).mean : std::log1p(audit->deviation);
  }
  std::vector<double> values, sigmas;
  for (const MarkerScale& marker : audit->markers) {
    values.push_back(std::log1p(marker.deviation) - means.at(marker.part));
    sigmas.push_back(marker.sigma.value_or(0.0));
  }
  const RobustMean mean = FitMeanRobustly(values, sigmas);
  audit->marker_spread = mean.excess_sigma;
  for (std::size_t i = 0; i < values.size(); ++i) {
    audit->markers[i].sigmas_off = mean.sigmas_off[i];
  }
}

void CompareSizes(ScaleAudit* audit) {
  const auto length_of = [](const MarkerScale& marker) { return marker.length_m; };
  for (auto& [length_m, scale] : CompareGroups<double>(*audit, length_of)) {
    audit->sizes.push_back(scale);
    audit->sizes.back().length_m = length_m;
  }
}

PrintSpread SpreadOf(const std::vector<MarkerScale>& markers) {
  std::vector<SpreadSample> samples;
  for (const MarkerScale& marker : markers) {
    samples.push_back({-std::log1p(marker.deviation), marker.sigma.value_or(0.0), marker.length_m,
                       marker.side_px});
  }
  return EstimateSpread(samples);
}

void SummarizeDistances(ScaleAudit* audit) {
  std::vector<double> values, sigmas;
  for (const CheckedDistance& checked : audit->distances) {
    if (!checked.distance_m || *checked.distance_m == 0 || !checked.IsCheck()) continue;
    values.push_back(std::log(*checked.distance_m / checked.known.length_m));
    sigmas.push_back(checked.DifferenceSigma() / checked.known.length_m);
  }
  if (values.empty()) return;
  const RobustMean mean = FitMeanRobustly(values, sigmas);
  audit->distance_deviation = std::expm1(mean.mean);
  audit->distance_deviation_sigma = mean.sigma;
}

}  // namespace

bool MarkerScale::Disagrees() const { return std::abs(sigmas_off) > kMaxRobustSigmas; }

ScaleAudit AuditScale(const MarkerShape& shape, const Layout& layout, const Model* model,
                      const AdjustmentUncertainty* uncertainty) {
  ScaleAudit audit;
  audit.distances =
      CheckDistances(shape, layout, uncertainty != nullptr ? &uncertainty->points : nullptr);
  SummarizeDistances(&audit);
  if (uncertainty != nullptr && uncertainty->apparent_inset_sigma_px > 0) {
    audit.apparent_inset_px = {uncertainty->apparent_inset_px,
                               uncertainty->apparent_inset_sigma_px};
  }
  std::vector<MeasuredMarkerSides> measured = MeasureForShape(shape, layout, model, uncertainty);
  if (model != nullptr && uncertainty != nullptr && uncertainty->markers_bend) {
    audit.markers_bend = true;
    MeasureAlongBends(*model, layout, &measured);
  }
  RemoveDegenerateMarkers(&measured);
  audit.markers = ScalesOf(measured, layout);
  audit.spread = SpreadOf(audit.markers);
  if (audit.markers.empty()) return audit;
  CompareMarkersWithMean(&audit);
  audit.histogram = MakeDeviationHistogram(audit.markers);
  CompareWidthAndHeight(measured, &audit);
  CompareParts(&audit);
  audit.parts_disagree = PartsDisagree(audit.parts);
  if (audit.parts_disagree) {
    CompareMarkersWithTheirParts(&audit);
    CompareParts(&audit);  // with the spread that is left
  }
  CompareSizes(&audit);
  return audit;
}

}  // namespace velamap
