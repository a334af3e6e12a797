#include "importer/track/prior_shape_expectation.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "importer/detect/search_regions.h"
#include "importer/geometry/consensus_pose.h"

namespace velamap {
namespace {

// Smallest ratio of area to squared longest side: a marker seen at more than 80 degrees from its
// normal can hardly be read.
constexpr double kMinFacing = 0.17;

std::optional<QuadCorners> RaysOf(const Camera& camera, const QuadCorners& corners_px) {
  QuadCorners rays;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    const auto ray = CamFromImage(camera, corners_px[c].array() + kImageFromOpenCvPx);
    if (!ray) return std::nullopt;
    rays[c] = *ray;
  }
  return rays;
}

// Returns nothing unless the whole marker is in front of the camera and within the field of view,
// outside of which a distortion model may fold over.
std::optional<QuadCorners> Reproject(const Camera& camera, const Rigid3& cam_from_shape,
                                     const std::array<Eigen::Vector3d, kNumCorners>& in_shape_m) {
  QuadCorners corners_px;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    const Eigen::Vector3d x_in_cam = cam_from_shape * in_shape_m[c];
    const auto in_image_px = ImageFromCam(camera, x_in_cam);
    if (!in_image_px) return std::nullopt;
    const auto ray = CamFromImage(camera, *in_image_px);
    if (!ray || (*ray - x_in_cam.hnormalized()).norm() > 1e-6) return std::nullopt;
    corners_px[c] = in_image_px->array() - kImageFromOpenCvPx;
  }
  return corners_px;
}

// Positive where the corners run clockwise in the image, so that the face is visible.
double SignedArea(const QuadCorners& quad) {
  return 0.5 * Cross(quad[2] - quad[0], quad[3] - quad[1]);
}

bool FacesCamera(const QuadCorners& quad) {
  double longest_px = 0.0;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    longest_px = std::max(longest_px, (quad[(c + 1) % kNumCorners] - quad[c]).norm());
  }
  return SignedArea(quad) > kMinFacing * longest_px * longest_px;
}

}  // namespace

std::optional<PriorShapeView> PlaceInPriorShape(const PriorShape& prior_shape, const Camera& camera,
                                                const std::vector<MarkerQuad>& found,
                                                PriorShapeAgreement* agreement) {
  *agreement = {};
  std::vector<MarkerQuad> known;
  std::vector<MarkerRays> markers;
  for (const auto& [marker_id, corners_px] : SingleMarkers(found)) {
    const auto in_shape_m = prior_shape.find(marker_id);
    const auto rays = RaysOf(camera, corners_px);
    if (in_shape_m == prior_shape.end() || !rays) continue;
    known.push_back({marker_id, corners_px});
    markers.push_back({in_shape_m->second, *rays});
  }
  if (markers.size() < kMinConsensus) return std::nullopt;
  agreement->num_known = static_cast<int>(markers.size());
  const auto pose = FindConsensusPose(std::move(markers));
  if (!pose) return std::nullopt;
  agreement->num_agreeing = static_cast<int>(pose->inlier_idxs.size());
  PriorShapeView view{pose->cam_from_space, {}};
  for (const int idx : pose->inlier_idxs) {
    const MarkerQuad& quad = known[static_cast<std::size_t>(idx)];
    const auto place_px = Reproject(camera, view.cam_from_shape, prior_shape.at(quad.marker_id));
    if (!place_px) continue;
    view.departures.push_back({QuadCenter(*place_px), QuadCenter(quad.corners_px)});
  }
  return view;
}

std::vector<ExpectedMarker> ExpectByPriorShape(const PriorShape& prior_shape, const Camera& camera,
                                               const PriorShapeView& view,
                                               const std::vector<MarkerQuad>& found) {
  std::set<int> found_ids;
  for (const MarkerQuad& quad : found) found_ids.insert(quad.marker_id);
  std::vector<ExpectedMarker> all;
  for (const auto& [marker_id, in_shape_m] : prior_shape) {
    if (found_ids.count(marker_id) > 0) continue;
    auto corners_px = Reproject(camera, view.cam_from_shape, in_shape_m);
    if (!corners_px || !FacesCamera(*corners_px)) continue;
    const Eigen::Vector2d departure_px = LocalMotion(view.departures, QuadCenter(*corners_px));
    for (Eigen::Vector2d& corner : *corners_px) corner += departure_px;
    const double reach_px =
        4.0 + 0.3 * QuadMeanSide(*corners_px) + 0.5 * std::min(departure_px.norm(), 40.0);
    if (!FitsIn(BoundingBox(*corners_px), {camera.width_px, camera.height_px}, reach_px)) continue;
    all.push_back({{marker_id, *corners_px}, reach_px});
  }
  return all;
}

}  // namespace velamap
