// Compares the distances of the layout, measured by hand, with the result.

#pragma once

#include <optional>
#include <vector>

#include "exporters/shape/marker_shape.h"
#include "importer/layout/layout.h"
#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

struct CheckedDistance {
  KnownDistance known;
  std::optional<double> distance_m;  // in the shape; nothing if it lacks one of the points
  std::optional<double> sigma_m;     // of distance_m

  // 1 sigma of the difference, from the tape and, if known, from the result.
  double DifferenceSigma() const;
  // Difference (result - tape) over its sigma; the distance must be in the shape.
  double DifferenceInSigmas() const;
  // Whether the distance is only compared with the shape. So is a scale bar where the shape has no
  // sigmas, because only the adjustment that gives them uses scale bars.
  bool IsCheck() const { return !known.is_scale_bar || !sigma_m; }
  // Whether it is a check in the shape that is off by more than three sigmas.
  bool FailsAsCheck() const;
};

constexpr double kMaxCheckSigmas = 3.0;

// One entry per distance of the layout, in its order.
std::vector<CheckedDistance> CheckDistances(const MarkerShape& shape, const Layout& layout,
                                            const PointCovariance* covariance = nullptr);

}  // namespace velamap
