// What a marker-aware bundle adjustment knows about the quality of its result. It travels beside
// the model as uncertainty.bin, which COLMAP ignores; a model folder that holds it is metric (m).

#pragma once

#include <string>

#include "reconstruct/geometry/point_covariance.h"

namespace velamap {

inline constexpr char kUncertaintyFileName[] = "uncertainty.bin";

struct AdjustmentUncertainty {
  // In the shape's own frame: of all rigid motions of the result none is known, so the covariance
  // is that after a least-squares alignment of all points with their true places (inner
  // constraints; Triggs et al., "Bundle Adjustment - A Modern Synthesis", 2000, section 9). Scaled
  // by the variance factor of the observations.
  PointCovariance points;
  // 1 sigma of the scale that is common to all points, as a fraction: corner noise, print tolerance
  // and apparent inset together. It is part of `points` too.
  double relative_scale_sigma = 0.0;
  // Of the weighted corner residuals: sum of squares / redundancy. 1 where the corners' sigmas are
  // right.
  double variance_factor = 1.0;
  // The corners' sigmas are taken this much larger in `points`, because errors that corners have in
  // common move the shape farther than independent ones. 1 where nothing of the kind is found.
  double correlation_factor = 1.0;
  // Of the corners that stayed, those off by more than 4 of their calibrated sigmas (without the
  // correlation factor).
  double share_above_4_sigma = 0.0;
  double apparent_inset_px =
      0.0;  // corners lie this far inside along x and y of the marker; 0: not estimated
  double apparent_inset_sigma_px = 0.0;
};

// In `folder`. Reading throws InputError that names the file for a truncated or foreign one; a
// folder without the file gives nothing (std::nullopt is for the caller: see HasUncertainty).
void WriteUncertainty(const AdjustmentUncertainty& uncertainty, const std::string& folder);
bool HasUncertainty(const std::string& folder);
AdjustmentUncertainty ReadUncertainty(const std::string& folder);

}  // namespace velamap
