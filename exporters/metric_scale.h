// Metric scale of a model from the known marker sides (thesis section 3.5.1, made robust).

#pragma once

#include <map>

#include "importer/layout.h"
#include "reconstruct/model.h"

namespace velamap {

struct ScaleEstimate {
  double m_per_unit = 0.0;
  // Standard deviation over the markers of the scale that each gives alone, as a fraction of the
  // scale; robust (1.4826 MAD).
  double relative_spread = 0.0;
  int num_markers = 0;                  // markers used
  std::map<int, double> m_per_unit_of;  // by marker id, what each marker gives alone
};

// Each whole marker gives printed side / mean of its four sides. The scale is the mean of the
// ratios within three robust sigmas of their median, so that no misdetected marker moves it. Throws
// DataError if no marker is whole.
ScaleEstimate EstimateScale(const Model& model, const Layout& layout);

}  // namespace velamap
