#include "exporters/scale/scale_csv.h"

#include <ostream>

#include "importer/text/csv.h"

namespace velamap {

void WriteScaleCsv(const ScaleEstimate& scale, std::ostream& out) {
  CsvWriter csv(out);
  csv.WriteRecord("marker_id", "m_per_unit", "relative_deviation");
  for (const auto& [marker_id, m_per_unit] : scale.m_per_unit_of) {
    csv.WriteRecord(marker_id, m_per_unit, m_per_unit / scale.m_per_unit - 1.0);
  }
}

}  // namespace velamap
