#include "workflows/plan/plan_surface.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "importer/base/error.h"
#include "importer/geometry/rigid3.h"
#include "importer/geometry/units.h"
#include "importer/layout/dictionary.h"
#include "reconstruct/geometry/marker_pose.h"

namespace velamap {
namespace {

// From places on the flat sail, mm, to space, m: x from luff to leech, y to leeward, z up.
using BentSurface = std::function<Eigen::Vector3d(const Eigen::Vector2d&)>;

Eigen::Vector3d OnFlatSurface(const Eigen::Vector2d& place_mm) {
  return kMPerMm * Eigen::Vector3d(place_mm.x(), 0, place_mm.y());
}

BentSurface Bend(const Placement& placement, double camber, double twist_rad) {
  if (placement.sail_mm.empty()) return OnFlatSurface;
  const Eigen::Vector2d clew_mm = placement.sail_mm[1];
  const double luff_mm = placement.sail_mm[2].y(), foot_mm = clew_mm.norm();
  return [=](const Eigen::Vector2d& place_mm) -> Eigen::Vector3d {
    // The place as the point `along` of a line parallel to the foot at the fraction `up` of the
    // luff.
    const double along = place_mm.x() / clew_mm.x();
    const double up = (place_mm.y() - along * clew_mm.y()) / luff_mm;
    const double chord = std::max(1e-6, 1 - up);
    const double s = std::clamp(along / chord, 0.0, 1.0);
    const double depth_mm = 4 * camber * chord * foot_mm * s * (1 - s);
    const double turn = twist_rad * up;
    return kMPerMm * Eigen::Vector3d(place_mm.x() * std::cos(turn) - depth_mm * std::sin(turn),
                                     place_mm.x() * std::sin(turn) + depth_mm * std::cos(turn),
                                     place_mm.y());
  };
}

ShapeMarker MakeMarker(int marker_id, const std::string& part, double length_m,
                       const Rigid3& surface_from_marker) {
  ShapeMarker marker;
  marker.marker_id = marker_id;
  marker.part = part;
  const auto corners = CornersInMarker(length_m);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    marker.x_in_shape_m[i + 1] = surface_from_marker * corners[i];
  }
  marker.x_in_shape_m[0] = surface_from_marker.translation;
  return marker;
}

// Upright, in the tangent plane of the surface at its centre.
Rigid3 TouchSurface(const BentSurface& surface, const Eigen::Vector2d& place_mm) {
  constexpr double kStep_mm = 1.0;
  const auto tangent = [&](const Eigen::Vector2d& step_mm) -> Eigen::Vector3d {
    return surface(place_mm + step_mm) - surface(place_mm - step_mm);
  };
  const Eigen::Vector3d right = tangent({kStep_mm, 0}).normalized();
  const Eigen::Vector3d normal = right.cross(tangent({0, kStep_mm})).normalized();
  Eigen::Matrix3d axes;
  axes << right, normal.cross(right), normal;
  return {Eigen::Quaterniond(axes), surface(place_mm)};
}

// A row below the foot, as on a hull, its ends below the ends of the lowest line.
void AddRigidPart(const LayoutPart& part, const Placement& placement, const Layout& layout,
                  MarkerShape* shape) {
  const PlacedLine& lowest = placement.horizontal.front();
  const double length_mm = placement.length_mm;
  const Eigen::Vector2d down_mm(0, -3 * length_mm);
  const Eigen::Vector2d begin_mm = lowest.markers.front().center_mm + down_mm;
  const Eigen::Vector2d end_mm = lowest.markers.back().center_mm + down_mm;
  for (std::size_t i = 0; i < part.marker_ids.size(); ++i) {
    const double place = (i + 0.5) / part.marker_ids.size();
    const int id = part.marker_ids[i];
    shape->markers.push_back(
        MakeMarker(id, part.name, MarkerLength(layout, id),
                   TouchSurface(OnFlatSurface, begin_mm + place * (end_mm - begin_mm))));
  }
}

// Moves the shape into the plan frame. Its markers are upright and face the camera.
void IntoPlanFrame(MarkerShape* shape) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), normal = middle, up = middle;
  for (const ShapeMarker& marker : shape->markers) {
    const auto& x = marker.x_in_shape_m;
    middle += *x[0] / static_cast<double>(shape->markers.size());
    normal += MarkerNormal(marker);
    up += (*x[1] - *x[4]).normalized();
  }
  const Eigen::Vector3d y = -normal.normalized();
  const Eigen::Vector3d x = y.cross(up).normalized();
  Eigen::Matrix3d plan_from_shape;
  plan_from_shape << x.transpose(), y.transpose(), x.cross(y).transpose();
  for (ShapeMarker& marker : shape->markers) {
    for (auto& point : marker.x_in_shape_m) point = plan_from_shape * (*point - middle);
  }
}

// Sorts the markers, notes those that are missing, and finds the frame.
PlannedSurface Finish(MarkerShape shape, const Layout& layout) {
  PlannedSurface surface;
  surface.layout = layout;
  surface.num_cells = CellsPerSide(LoadDictionary(layout.dictionary), layout.border_bits);
  std::sort(shape.markers.begin(), shape.markers.end(),
            [](const ShapeMarker& a, const ShapeMarker& b) { return a.marker_id < b.marker_id; });
  for (const int id : MarkerIds(layout)) {
    if (FindMarker(shape, id) == nullptr) surface.markers_left_out.push_back(id);
  }
  IntoPlanFrame(&shape);
  surface.shape = std::move(shape);
  return surface;
}

}  // namespace

PlannedSurface SurfaceOfPlacement(const Placement& placement, const Layout& layout, double camber,
                                  double twist_deg) {
  const BentSurface bent = Bend(placement, camber, kRadPerDeg * twist_deg);
  MarkerShape shape;
  for (const PlacedLine& line : placement.horizontal) {
    for (const MarkerPlace& marker : line.markers) {
      shape.markers.push_back(MakeMarker(marker.marker_id, placement.part,
                                         MarkerLength(layout, marker.marker_id),
                                         TouchSurface(bent, marker.center_mm)));
    }
  }
  for (const LayoutPart& part : layout.parts) {
    if (part.rigid && part.name != placement.part) AddRigidPart(part, placement, layout, &shape);
  }
  return Finish(std::move(shape), layout);
}

PlannedSurface SurfaceOfShape(const MarkerShape& shape, const Layout& layout,
                              const std::string& path) {
  const std::vector<int> ids = MarkerIds(layout);
  MarkerShape known;
  for (const ShapeMarker& marker : shape.markers) {
    const bool is_named =
        !layout.HasMarkers() || std::binary_search(ids.begin(), ids.end(), marker.marker_id);
    if (marker.IsWhole() && is_named) known.markers.push_back(marker);
  }
  if (known.markers.empty()) {
    throw InputError(fmt::format(
        "--shape_path: {}: it holds no whole marker of the layout; give a shape of these markers",
        path));
  }
  PlannedSurface surface = Finish(std::move(known), layout);
  surface.is_of_shape = true;
  return surface;
}

}  // namespace velamap
