// scale.csv: the metric scale from each marker alone, outliers included. Header
//   marker_id,m_per_unit,relative_deviation
// relative_deviation is m_per_unit over the scale of the whole model, minus 1.

#pragma once

#include <iosfwd>

#include "exporters/scale/metric_scale.h"

namespace velamap {

void WriteScaleCsv(const ScaleEstimate& scale, std::ostream& out);

}  // namespace velamap
