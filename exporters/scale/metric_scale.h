// Metric scale of a model from the known marker sides (thesis section 3.5.1, made robust).

#pragma once

#include <map>
#include <optional>

#include "importer/layout/layout.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

enum class ScaleMethod {
  kAgreeing,  // mean over the markers that agree
  kMeanSide,  // thesis 3.5.1: the printed side divided by the mean of all sides
};

struct ScaleEstimate {
  double m_per_unit = 0.0;
  // Robust standard deviation (1.4826 MAD) of the scales that single markers give, as a fraction.
  double relative_spread = 0.0;
  // Standard deviation of m_per_unit as a fraction. With an uncertainty, the joint one of the
  // adjustment: noise of the corners, print tolerance, apparent inset, scale bars. Without one, the
  // standard error of the mean over the markers used, which excludes errors that all markers share;
  // nothing for a single marker.
  std::optional<double> relative_sigma;
  double print_sigma = 0.0;             // AdjustmentUncertainty::print_scale_sigma
  int num_markers = 0;                  // markers used
  std::map<int, double> m_per_unit_of;  // scale from each marker alone, by marker id
};

// Each whole marker gives the ratio of its printed side to the mean of its four sides. kAgreeing:
// the scale is the mean of the ratios within three robust sigmas of their median, which excludes
// misdetected markers. kMeanSide: the sum of all printed sides divided by the sum of the measured
// ones. Throws DataError without a whole marker.
ScaleEstimate EstimateScale(const Model& model, const Layout& layout,
                            ScaleMethod method = ScaleMethod::kAgreeing);

// The scale of a metric model: 1, with the sigma of the uncertainty. `m_per_unit_of` are the scales
// of single markers from the images alone (scale_audit.h).
ScaleEstimate MetricScale(std::map<int, double> m_per_unit_of,
                          const AdjustmentUncertainty& uncertainty);

}  // namespace velamap
