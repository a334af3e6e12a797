#include "exporters/scale/metric_scale.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "exporters/scale/marker_sides.h"
#include "exporters/scale/metric_shape.h"
#include "exporters/scale/robust_fit.h"
#include "importer/base/statistics.h"

namespace velamap {
namespace {

// Tolerates rounding errors if all markers agree and the robust sigma is almost zero.
constexpr double kRoundingTolerance = 1e-9;

[[noreturn]] void ThrowNoWholeMarker(const Model& model) {
  const auto is_corner = [](const auto& point) { return IsCornerPoint3DId(point.first); };
  const auto num_corners = std::count_if(model.points3D.begin(), model.points3D.end(), is_corner);
  std::string message =
      "no marker of the model has all four corners, so the metric scale is unknown (" +
      std::to_string(model.points3D.size()) + " points, " + std::to_string(num_corners) +
      " of them marker corners)";
  if (num_corners == 0 && !model.points3D.empty()) {
    message += "; point ids must be 10 * marker id + corner, as velamap writes them";
  }
  throw DataError(message);
}

// The scale from each marker alone, without markers that degenerate to a point.
std::map<int, double> RatiosOf(const std::vector<MeasuredMarkerSides>& markers,
                               const Layout& layout) {
  std::map<int, double> ratios;
  for (const MeasuredMarkerSides& marker : markers) {
    const double ratio = MarkerLength(layout, marker.marker_id) / MeanSide(marker.sides);
    if (std::isfinite(ratio)) ratios[marker.marker_id] = ratio;
  }
  return ratios;
}

struct Agreement {
  double robust_sigma = 0.0;
  std::vector<double> ratios;  // within the limit
};

std::vector<double> ValuesOf(const std::map<int, double>& ratio_of) {
  std::vector<double> ratios;
  for (const auto& [marker_id, ratio] : ratio_of) ratios.push_back(ratio);
  return ratios;
}

double PrintedOverMeanSide(const std::vector<MeasuredMarkerSides>& markers, const Layout& layout) {
  double printed = 0.0, measured = 0.0;
  for (const MeasuredMarkerSides& marker : markers) {
    if (!(MeanSide(marker.sides) > 0)) continue;  // as in RatiosOf()
    printed += MarkerLength(layout, marker.marker_id);
    measured += MeanSide(marker.sides);
  }
  return printed / measured;
}

Agreement FindAgreement(const std::map<int, double>& ratio_of) {
  const std::vector<double> ratios = ValuesOf(ratio_of);
  Agreement agreement;
  const double median = Median(ratios);
  agreement.robust_sigma = RobustSigma(ratios);
  const double max_deviation =
      kMaxRobustSigmas * agreement.robust_sigma + kRoundingTolerance * median;
  for (const double ratio : ratios) {
    if (std::abs(ratio - median) <= max_deviation) agreement.ratios.push_back(ratio);
  }
  return agreement;
}

}  // namespace

ScaleEstimate EstimateScale(const Model& model, const Layout& layout, ScaleMethod method) {
  const std::vector<MeasuredMarkerSides> markers = MeasureSides(ShapeFromModel(model, layout));
  ScaleEstimate estimate;
  estimate.m_per_unit_of = RatiosOf(markers, layout);
  if (estimate.m_per_unit_of.empty()) ThrowNoWholeMarker(model);
  Agreement agreement = FindAgreement(estimate.m_per_unit_of);
  if (method == ScaleMethod::kMeanSide) agreement.ratios = ValuesOf(estimate.m_per_unit_of);
  const Statistics statistics = ComputeStatistics(agreement.ratios);
  estimate.num_markers = statistics.count;
  estimate.m_per_unit =
      method == ScaleMethod::kMeanSide ? PrintedOverMeanSide(markers, layout) : statistics.mean;
  estimate.relative_spread = agreement.robust_sigma / estimate.m_per_unit;
  if (statistics.count > 1) {
    estimate.relative_sigma =
        statistics.standard_deviation / std::sqrt(statistics.count) / estimate.m_per_unit;
  }
  return estimate;
}

ScaleEstimate MetricScale(std::map<int, double> m_per_unit_of,
                          const AdjustmentUncertainty& uncertainty) {
  ScaleEstimate estimate;
  estimate.m_per_unit = 1.0;
  estimate.relative_sigma = uncertainty.relative_scale_sigma;
  estimate.print_sigma = uncertainty.print_scale_sigma;
  estimate.m_per_unit_of = std::move(m_per_unit_of);
  if (estimate.m_per_unit_of.empty()) return estimate;  // a scale bar needs no marker
  const Agreement agreement = FindAgreement(estimate.m_per_unit_of);
  estimate.relative_spread = agreement.robust_sigma;
  estimate.num_markers = static_cast<int>(agreement.ratios.size());
  return estimate;
}

}  // namespace velamap
