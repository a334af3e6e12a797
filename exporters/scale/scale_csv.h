// scale.csv: what each marker alone says of the metric scale. Header
// marker_id,m_per_unit,relative_deviation
// relative_deviation is m_per_unit / the scale of the whole model - 1; classic locale, shortest
// digits that read back to the same double. Outliers are listed too: this is where they show.

#pragma once

#include <iosfwd>

#include "exporters/scale/metric_scale.h"

namespace velamap {

void WriteScaleCsv(const ScaleEstimate& scale, std::ostream& out);

}  // namespace velamap
