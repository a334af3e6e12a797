#include "reconstruct/sizes/runaway_markers.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <Eigen/Core>

#include "importer/geometry/quad.h"
#include "reconstruct/geometry/marker_pose.h"
#include "reconstruct/problem/marker_state.h"
#include "reconstruct/problem/prior_cost_functions.h"

namespace velamap {
namespace {

using CornersInWorld = std::array<Eigen::Vector3d, kNumCorners>;

// A marker in an image that sees all its corners.
struct WholeView {
  const ModelImage* image = nullptr;
  QuadCorners corners_px;
};

bool HasRunAway(const MarkerBlock& marker) {
  constexpr double kMaxFactor = 2.0;
  for (const auto& [a, b] : MarkerPriorError::Sides(marker.corners)) {
    const double side_m = (CornerPosition(marker, b) - CornerPosition(marker, a)).norm();
    if (!(side_m < kMaxFactor * marker.length_m && kMaxFactor * side_m > marker.length_m)) {
      return true;
    }
  }
  return false;
}

std::vector<WholeView> WholeViewsOf(int marker_id, const Model& model) {
  std::map<ImageId, std::array<std::optional<Eigen::Vector2d>, kNumCorners>> seen;
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    for (const TrackElement& element :
         model.points3D.at(Point3DIdFromCorner({marker_id, corner})).track) {
      seen[element.image_id][static_cast<std::size_t>(corner - 1)] =
          model.FindImage(element.image_id)->points2D.at(element.point2D_idx).x_in_image_px;
    }
  }
  std::vector<WholeView> views;
  for (const auto& [image_id, corners] : seen) {
    WholeView view{model.FindImage(image_id), {}};
    bool is_whole = true;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      is_whole = is_whole && corners[i].has_value();
      view.corners_px[i] = corners[i].value_or(Eigen::Vector2d::Zero());
    }
    if (is_whole) views.push_back(view);
  }
  return views;
}

// Root mean square over all views of the reprojection error divided by the side in the image;
// infinite for a place behind a camera.
double RelativeError(const CornersInWorld& corners, const std::vector<WholeView>& views,
                     const Model& model) {
  double sum = 0.0;
  for (const WholeView& view : views) {
    const double side_px = QuadMeanSide(view.corners_px);
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const auto x_px = ImageFromCam(model.cameras.at(view.image->camera_id),
                                     view.image->cam_from_world * corners[i]);
      if (!x_px) return std::numeric_limits<double>::infinity();
      sum += (*x_px - view.corners_px[i]).squaredNorm() / (side_px * side_px);
    }
  }
  return std::sqrt(sum / static_cast<double>(kNumCorners * views.size()));
}

// Returns nothing if no place explains the views.
std::optional<CornersInWorld> PlaceByOneView(const MarkerBlock& marker, const Model& model) {
  constexpr double kMaxError = 0.2;  // of the side in the image
  const std::vector<WholeView> views = WholeViewsOf(marker.marker_id, model);
  std::optional<CornersInWorld> best;
  double least = kMaxError;
  for (const WholeView& view : views) {
    for (const MarkerPose& pose : EstimateMarkerPoses(model.cameras.at(view.image->camera_id),
                                                      view.corners_px, marker.length_m)) {
      const Rigid3 world_from_marker = Inverse(view.image->cam_from_world) * pose.cam_from_marker;
      CornersInWorld corners = CornersInMarker(marker.length_m);
      for (Eigen::Vector3d& corner : corners) corner = world_from_marker * corner;
      const double error = RelativeError(corners, views, model);
      if (!(error < least)) continue;
      least = error;
      best = corners;
    }
  }
  return best;
}

}  // namespace

std::vector<int> PlaceRunawayMarkersAnew(const Layout& layout, Model* model) {
  std::vector<int> marker_ids;
  for (const MarkerBlock& marker : MakeMarkerState(*model, layout).markers) {
    if (marker.corners.size() != kNumCorners || !HasRunAway(marker)) continue;
    const std::optional<CornersInWorld> corners = PlaceByOneView(marker, *model);
    if (!corners) continue;
    for (int corner = 1; corner <= kNumCorners; ++corner) {
      model->points3D.at(Point3DIdFromCorner({marker.marker_id, corner})).x_in_world =
          (*corners)[static_cast<std::size_t>(corner - 1)];
    }
    marker_ids.push_back(marker.marker_id);
  }
  return marker_ids;
}

}  // namespace velamap
