#include "exporters/surface_csv.h"

#include <ostream>

#include <fmt/format.h>

#include "exporters/csv.h"

namespace velamap {

void WriteSurfaceResidualsCsv(const FittedSurface& surface, std::ostream& out) {
  out << "marker_id,line,u,v,distance,beyond_edge,is_used\n";
  for (const SurfaceResidual& residual : surface.residuals) {
    out << fmt::format("{},{},{},{},{},{},{}\n", residual.marker_id, CsvField(residual.line),
                       residual.u, residual.v, residual.distance_m, residual.beyond_edge_m,
                       residual.is_used ? 1 : 0);
  }
}

}  // namespace velamap
