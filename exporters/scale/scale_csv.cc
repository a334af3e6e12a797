#include "exporters/scale/scale_csv.h"

#include <ostream>

#include <fmt/format.h>

namespace velamap {

void WriteScaleCsv(const ScaleEstimate& scale, std::ostream& out) {
  out << "marker_id,m_per_unit,relative_deviation\n";
  for (const auto& [marker_id, m_per_unit] : scale.m_per_unit_of) {
    out << fmt::format("{},{},{}\n", marker_id, m_per_unit, m_per_unit / scale.m_per_unit - 1.0);
  }
}

}  // namespace velamap
