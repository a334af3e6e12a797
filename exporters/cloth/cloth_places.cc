#include "exporters/cloth/cloth_places.h"

#include "exporters/surface/surface_input.h"
#include "importer/base/error.h"

namespace velamap {

ClothOffsets OffsetsToCloth(const FittedSurface& fit) {
  ClothOffsets offsets_m;
  for (const SurfaceResidual& residual : fit.residuals) {
    if (!residual.is_used) continue;
    offsets_m[residual.marker_id] =
        residual.bend_m * EvaluateNormal(fit.surface, residual.u, residual.v);
  }
  return offsets_m;
}

ClothOffsets OffsetsToCloth(const MarkerShape& shape, const Layout& layout,
                            const std::optional<Eigen::Vector3d>& up_in_shape) {
  ClothOffsets offsets_m;
  for (const LayoutPart& part : layout.parts) {
    if (part.horizontal.empty()) continue;
    try {
      offsets_m.merge(OffsetsToCloth(FitSurface(CollectSurfaceInput(shape, part, up_in_shape))));
    } catch (const DataError&) {
      // Its markers determine no surface, so the bend of the cloth is unknown.
    }
  }
  return offsets_m;
}

void MoveCenters(const ClothOffsets& offsets_m, MarkerShape* shape) {
  for (ShapeMarker& marker : shape->markers) {
    const auto offset_m = offsets_m.find(marker.marker_id);
    if (offset_m == offsets_m.end() || !marker.x_in_shape_m[0]) continue;
    *marker.x_in_shape_m[0] += offset_m->second;
  }
}

}  // namespace velamap
