#include "workflows/plan/plan_views.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <Eigen/Geometry>

#include "importer/base/statistics.h"
#include "importer/geometry/look_at.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

// The share of markers that are found is a logistic function of the pixels per cell on the narrow
// side: where it is one half, and its width. All numbers here come from studies/shooting.sh.
constexpr double kPxPerCellForHalf = 1.5, kPxPerCellWidth = 0.17;
constexpr double kToleratedMotionCells = 0.5;

double FoundShare(double narrow_px, int num_cells) {
  return 1 / (1 + std::exp((kPxPerCellForHalf - narrow_px / num_cells) / kPxPerCellWidth));
}

std::optional<MarkerView> SeeMarker(const ShapeMarker& marker, int num_cells, const Camera& camera,
                                    double max_ray_length, const Rigid3& cam_from_plan) {
  constexpr double kBorder_px = 3.0;
  MarkerView view;
  view.marker_id = marker.marker_id;
  double longest_px = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const Eigen::Vector3d x_in_cam = cam_from_plan * *marker.x_in_shape_m[i + 1];
    // Distortion may fold what lies far outside the picture back into it.
    if (!(x_in_cam.z() > 0) || x_in_cam.hnormalized().norm() > max_ray_length) return std::nullopt;
    const auto x_px = ImageFromCam(camera, x_in_cam);
    if (!x_px || x_px->minCoeff() < kBorder_px || x_px->x() > camera.width_px - kBorder_px ||
        x_px->y() > camera.height_px - kBorder_px) {
      return std::nullopt;
    }
    view.corners_in_image_px[i] = *x_px;
  }
  const QuadCorners& c = view.corners_in_image_px;
  // The corners go clockwise as the face is seen, y down.
  if (!(Cross(c[2] - c[0], c[3] - c[1]) > 0)) return std::nullopt;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    longest_px = std::max(longest_px, (c[(i + 1) % kNumCorners] - c[i]).norm());
  }
  view.side_px = std::sqrt(QuadArea(c));
  view.narrow_px = QuadArea(c) / longest_px;
  view.found_share = FoundShare(view.narrow_px, num_cells);
  return view;
}

}  // namespace

double LowestDepth(const PlannedSurface& surface) {
  double depth_m = 0.0;
  for (const ShapeMarker& marker : surface.shape.markers) {
    depth_m = std::max(depth_m, -marker.x_in_shape_m[0]->z());
  }
  return depth_m;
}

Rigid3 CameraAt(const PlannedSurface& surface, const PlannedPath& path, double angle_deg) {
  const double angle = kRadPerDeg * angle_deg;
  return LookAt({path.distance_m * std::sin(angle), -path.distance_m * std::cos(angle),
                 path.height_m - LowestDepth(surface)},
                Eigen::Vector3d::Zero());
}

std::vector<double> AnglesOf(const PlannedPath& path) {
  std::vector<double> angles_deg;
  for (int i = 0; i < path.num_views; ++i) {
    const double part = path.num_views > 1 ? double(i) / (path.num_views - 1) : 0.5;
    angles_deg.push_back(path.arc_deg * (part - 0.5));
  }
  return angles_deg;
}

std::vector<MarkerView> SeeMarkers(const PlannedSurface& surface, const Camera& camera,
                                   const Rigid3& cam_from_plan) {
  std::vector<MarkerView> views;
  const double max_ray_length = MaxRayLength(camera);
  for (const ShapeMarker& marker : surface.shape.markers) {
    const auto view = SeeMarker(marker, surface.num_cells, camera, max_ray_length, cam_from_plan);
    if (view) views.push_back(*view);
  }
  return views;
}

std::vector<int> MarkersOutsidePicture(const PlannedSurface& surface, const Camera& camera,
                                       const Rigid3& cam_from_plan) {
  // A marker that is seen nearly edge-on is not found in the picture either.
  constexpr double kLeastCosine = 0.1;
  std::set<int> seen;
  for (const MarkerView& view : SeeMarkers(surface, camera, cam_from_plan)) {
    seen.insert(view.marker_id);
  }
  const Eigen::Vector3d camera_in_plan_m = Inverse(cam_from_plan).translation;
  std::vector<int> outside;
  for (const ShapeMarker& marker : surface.shape.markers) {
    const Eigen::Vector3d to_camera = (camera_in_plan_m - *marker.x_in_shape_m[0]).normalized();
    if (MarkerNormal(marker).dot(to_camera) > kLeastCosine && seen.count(marker.marker_id) == 0) {
      outside.push_back(marker.marker_id);
    }
  }
  return outside;
}

ViewSummary Summarize(const PlannedSurface& surface,
                      const std::vector<std::vector<MarkerView>>& views) {
  ViewSummary summary;
  std::vector<double> sides_px, narrow_px;
  for (const std::vector<MarkerView>& view : views) {
    for (const MarkerView& marker : view) {
      sides_px.push_back(marker.side_px);
      narrow_px.push_back(marker.narrow_px);
      summary.found_share += marker.found_share;
    }
  }
  if (sides_px.empty()) return summary;
  const double num_possible = static_cast<double>(surface.shape.markers.size() * views.size());
  summary.in_picture_share = static_cast<double>(sides_px.size()) / num_possible;
  summary.found_share /= num_possible;
  summary.median_side_px = Median(std::move(sides_px));
  summary.median_narrow_px = Median(std::move(narrow_px));
  return summary;
}

double NarrowPxForHalf(int num_cells) { return kPxPerCellForHalf * num_cells; }

double ExpectedCornerSigma(double corner_sigma_px, double side_px) {
  // Noise that averages out along an edge, and the error of the encoder, which does not depend on
  // the size.
  const auto relative = [](double side) { return std::hypot(0.05, 0.6 / side); };
  return corner_sigma_px * relative(side_px) / relative(20.0);
}

double ToleratedMotionPx(double narrow_px, int num_cells) {
  return kToleratedMotionCells * narrow_px / num_cells;
}

}  // namespace velamap
