#include "exporters/cloth/cloth_places.h"

#include <map>

#include "exporters/surface/surface_input.h"
#include "importer/base/error.h"

namespace velamap {

void MoveCentersToCloth(const FittedSurface& fit, MarkerShape* shape) {
  std::map<int, Eigen::Vector3d> moves_m;
  for (const SurfaceResidual& residual : fit.residuals) {
    if (!residual.is_used) continue;
    moves_m[residual.marker_id] =
        residual.bend_m * EvaluateNormal(fit.surface, residual.u, residual.v);
  }
  for (ShapeMarker& marker : shape->markers) {
    const auto move_m = moves_m.find(marker.marker_id);
    if (move_m == moves_m.end() || !marker.x_in_shape_m[0]) continue;
    *marker.x_in_shape_m[0] += move_m->second;
  }
}

void MoveCentersToCloth(const Layout& layout, const std::optional<Eigen::Vector3d>& up_in_shape,
                        MarkerShape* shape) {
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty()) continue;
    try {
      MoveCentersToCloth(FitSurface(CollectSurfaceInput(*shape, part, up_in_shape)), shape);
    } catch (const DataError&) {
      // Its markers determine no surface, so that nothing says how the cloth bends.
    }
  }
}

}  // namespace velamap
