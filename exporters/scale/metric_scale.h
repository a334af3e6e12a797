// Metric scale of a model from the known marker sides (thesis section 3.5.1, made robust).

#pragma once

#include <map>
#include <optional>

#include "importer/layout/layout.h"
#include "reconstruct/model/adjustment_uncertainty.h"
#include "reconstruct/model/model.h"

namespace velamap {

struct ScaleEstimate {
  double m_per_unit = 0.0;
  // Standard deviation over the markers of the scale that each gives alone, as a fraction of the
  // scale; robust (1.4826 MAD).
  double relative_spread = 0.0;
  // Standard deviation of m_per_unit as a fraction. With an uncertainty the joint one of the
  // adjustment: noise of the corners, print tolerance, apparent inset, scale bars. Without: the
  // standard error of the mean over the markers used, which knows nothing of an error that all
  // markers share; nothing for a single marker.
  std::optional<double> relative_sigma;
  int num_markers = 0;                  // markers used
  std::map<int, double> m_per_unit_of;  // by marker id, what each marker gives alone
};

// Each whole marker gives printed side / mean of its four sides. The scale is the mean of the
// ratios within three robust sigmas of their median, so that no misdetected marker moves it. Throws
// DataError if no marker is whole.
ScaleEstimate EstimateScale(const Model& model, const Layout& layout);

// Of a model that is metric already: the scale is 1, its sigma the uncertainty's; `m_per_unit_of`
// is what each marker gives by the images alone (scale_audit.h).
ScaleEstimate MetricScale(std::map<int, double> m_per_unit_of,
                          const AdjustmentUncertainty& uncertainty);

}  // namespace velamap
