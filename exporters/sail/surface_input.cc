#include "exporters/sail/surface_input.h"

#include <cmath>
#include <map>
#include <set>

#include "exporters/shape/shape_sigma.h"

namespace velamap {
namespace {

// The covariance without the errors that markers share.
std::optional<PointCovariance> OwnCovariance(const PointCovariance* covariance) {
  if (covariance == nullptr) return std::nullopt;
  PointCovariance own = *covariance;
  own.factor.setZero(own.factor.rows(), 0);
  own.signs.resize(0);
  return own;
}

std::optional<SurfaceMarker> Find(const std::map<int, const ShapeMarker*>& whole_markers,
                                  const PointCovariance* own_covariance, int marker_id) {
  const auto found = whole_markers.find(marker_id);
  if (found == whole_markers.end()) return std::nullopt;
  const ShapeMarker& marker = *found->second;
  SurfaceMarker result{marker_id, *marker.x_in_shape_m[0], std::nullopt};
  auto sigma_m = PointSigma(own_covariance, marker_id, 0);
  if (!sigma_m) sigma_m = marker.sigma_m[0];
  if (sigma_m) result.sigma_m = std::sqrt(sigma_m->squaredNorm() / 3);
  return result;
}

}  // namespace

SurfaceInput CollectSurfaceInput(const MarkerShape& shape, const LayoutPart& part,
                                 const PointCovariance* covariance) {
  const std::optional<PointCovariance> own = OwnCovariance(covariance);
  const PointCovariance* own_covariance = own ? &*own : nullptr;
  std::map<int, const ShapeMarker*> whole_markers;
  for (const ShapeMarker& marker : shape.markers) {
    if (marker.IsWhole()) whole_markers[marker.marker_id] = &marker;
  }
  SurfaceInput input;
  std::set<int> on_lines, others(part.marker_ids.begin(), part.marker_ids.end());
  for (const MarkerLine& line : part.horizontal) {
    SurfaceLine surface_line{line.name, {}};
    for (const int marker_id : line.marker_ids) {
      surface_line.markers.push_back(Find(whole_markers, own_covariance, marker_id));
      on_lines.insert(marker_id);
    }
    input.lines.push_back(surface_line);
  }
  for (const MarkerLine& line : part.vertical) {
    others.insert(line.marker_ids.begin(), line.marker_ids.end());
  }
  for (const int marker_id : others) {
    if (on_lines.count(marker_id) > 0) continue;
    if (const auto marker = Find(whole_markers, own_covariance, marker_id))
      input.markers.push_back(*marker);
  }
  return input;
}

}  // namespace velamap
