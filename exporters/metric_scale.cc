#include "exporters/metric_scale.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "exporters/metric_shape.h"
#include "reconstruct/statistics.h"

namespace velamap {
namespace {

constexpr double kMaxRobustSigmas = 3.0;
// Keeps rounding from deciding where all markers agree and the robust sigma is next to nothing.
constexpr double kRoundingTolerance = 1e-9;

[[noreturn]] void ThrowNoWholeMarker(const Model& model) {
  const auto is_corner = [](const auto& point) { return IsCornerPoint3DId(point.first); };
  const auto num_corners = std::count_if(model.points3D.begin(), model.points3D.end(), is_corner);
  std::string message =
      "no marker of the model has all four corners, so that nothing gives the metric scale (" +
      std::to_string(model.points3D.size()) + " points, " + std::to_string(num_corners) +
      " of them marker corners)";
  if (num_corners == 0 && !model.points3D.empty()) {
    message += "; point ids have to be 10 * marker id + corner, as velamap writes them";
  }
  throw DataError(message);
}

}  // namespace

ScaleEstimate EstimateScale(const Model& model, const Layout& layout) {
  ScaleEstimate estimate;
  std::vector<double> ratios;
  for (const ShapeMarker& marker : ShapeFromModel(model, layout).markers) {  // in model units
    if (!marker.IsWhole()) continue;
    const auto sides = MarkerSides(marker);
    const double mean_side = std::accumulate(sides.begin(), sides.end(), 0.0) / kNumCorners;
    const double ratio = MarkerLength(layout, marker.marker_id) / mean_side;
    if (!std::isfinite(ratio)) continue;  // all four corners on one point
    estimate.m_per_unit_of[marker.marker_id] = ratio;
    ratios.push_back(ratio);
  }
  if (ratios.empty()) ThrowNoWholeMarker(model);

  const double median = Median(ratios);
  const double robust_sigma = RobustSigma(ratios);
  const double max_deviation = kMaxRobustSigmas * robust_sigma + kRoundingTolerance * median;
  double sum = 0.0;
  for (const double ratio : ratios) {
    if (std::abs(ratio - median) > max_deviation) continue;
    sum += ratio;
    ++estimate.num_markers;
  }
  estimate.m_per_unit = sum / estimate.num_markers;
  estimate.relative_spread = robust_sigma / estimate.m_per_unit;
  return estimate;
}

}  // namespace velamap
