#include "importer/map_expectation.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <opencv2/calib3d.hpp>

namespace velamap {
namespace {

constexpr int kMinAgreeing = 4;
constexpr double kMinAgreeingPart = 0.5;

// Area over the square of the longest side: seen at 80 degrees from its normal, hardly a marker can
// be read.
constexpr double kMinFacing = 0.17;

struct KnownMarker {
  const std::array<Eigen::Vector3d, kNumCorners>* in_shape_m;
  QuadCorners rays;  // (x/z, y/z) in the cam frame
  QuadCorners corners_px;
};

std::optional<QuadCorners> RaysOf(const Camera& camera, const QuadCorners& corners_px) {
  QuadCorners rays;
  for (std::size_t c = 0; c < kNumCorners; ++c) {
    const auto ray = CamFromImage(camera, corners_px[c].array() + kImageFromOpenCvPx);
    if (!ray) return std::nullopt;
    rays[c] = *ray;
  }
  return rays;
}

std::vector<KnownMarker> FindKnown(const MarkerMap& map, const Camera& camera,
                                   const std::vector<MarkerQuad>& found) {
  std::map<int, int> count;
  for (const MarkerQuad& quad : found) ++count[quad.marker_id];
  // In order of id, so that the draw does not depend on that of `found`.
  std::map<int, KnownMarker> known;
  for (const MarkerQuad& quad : found) {
    const auto place = map.find(quad.marker_id);
    if (place == map.end() || count.at(quad.marker_id) > 1) continue;
    const auto rays = RaysOf(camera, quad.corners_px);
    if (rays) known[quad.marker_id] = {&place->second, *rays, quad.corners_px};
  }
  std::vector<KnownMarker> markers;
  for (const auto& [marker_id, marker] : known) markers.push_back(marker);
  return markers;
}

double MeanSide(const std::vector<KnownMarker>& known) {
  double sum_px = 0.0;
  for (const KnownMarker& marker : known) sum_px += QuadMeanSide(marker.corners_px);
  return sum_px / static_cast<double>(known.size());
}

// Nothing unless all of it is in front of the camera and within the field of view, beyond which a
// distortion model may fold over.
std::optional<QuadCorners> Reproject(const Camera& camera, const Eigen::Isometry3d& cam_from_shape,
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

// Corners of markers as OpenCV takes them.
struct Correspondences {
  std::vector<cv::Point3d> in_shape_m;
  std::vector<cv::Point2d> rays;
};

void Append(const KnownMarker& marker, std::size_t corner, Correspondences* all) {
  const Eigen::Vector3d& x = (*marker.in_shape_m)[corner];
  all->in_shape_m.emplace_back(x.x(), x.y(), x.z());
  all->rays.emplace_back(marker.rays[corner].x(), marker.rays[corner].y());
}

Eigen::Isometry3d IsometryFromOpenCV(const cv::Vec3d& rotation_vector,
                                     const cv::Vec3d& translation) {
  const Eigen::Vector3d axis_angle(rotation_vector[0], rotation_vector[1], rotation_vector[2]);
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  const double angle = axis_angle.norm();
  if (angle > 0) isometry.linear() = Eigen::AngleAxisd(angle, axis_angle / angle).matrix();
  isometry.translation() << translation[0], translation[1], translation[2];
  return isometry;
}

// cv::solvePnPRansac ends with EPnP on all that agree, which is unsteady on a surface that is
// nearly a plane; so only its consensus is taken.
std::optional<Eigen::Isometry3d> FindPose(const std::vector<KnownMarker>& known,
                                          double tolerance_in_rays) {
  constexpr int kMaxDraws = 100;
  constexpr double kConfidence = 0.9999;
  Correspondences all;
  for (const KnownMarker& marker : known) {
    for (std::size_t c = 0; c < kNumCorners; ++c) Append(marker, c, &all);
  }
  cv::Vec3d rotation_vector, translation;
  std::vector<int> consensus;
  if (!cv::solvePnPRansac(all.in_shape_m, all.rays, cv::Matx33d::eye(), cv::noArray(),
                          rotation_vector, translation, false, kMaxDraws,
                          static_cast<float>(tolerance_in_rays), kConfidence, consensus,
                          cv::SOLVEPNP_AP3P)) {
    return std::nullopt;
  }
  if (consensus.size() < kMinAgreeing * kNumCorners) return std::nullopt;
  Correspondences agreeing;
  for (const int idx : consensus) {
    const auto i = static_cast<std::size_t>(idx);
    Append(known[i / kNumCorners], i % kNumCorners, &agreeing);
  }
  if (!cv::solvePnP(agreeing.in_shape_m, agreeing.rays, cv::Matx33d::eye(), cv::noArray(),
                    rotation_vector, translation, false, cv::SOLVEPNP_SQPNP)) {
    return std::nullopt;
  }
  cv::solvePnPRefineLM(agreeing.in_shape_m, agreeing.rays, cv::Matx33d::eye(), cv::noArray(),
                       rotation_vector, translation);
  return IsometryFromOpenCV(rotation_vector, translation);
}

double SignedArea(const QuadCorners& quad) {  // positive: clockwise on the screen, a face seen
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

std::optional<MapView> PlaceOnMap(const MarkerMap& map, const Camera& camera,
                                  const std::vector<MarkerQuad>& found, MapAgreement* agreement) {
  *agreement = {};
  const std::vector<KnownMarker> known = FindKnown(map, camera, found);
  agreement->num_known = static_cast<int>(known.size());
  if (agreement->num_known < kMinAgreeing) return std::nullopt;
  const double tolerance_px = MeanSide(known);
  const auto cam_from_shape = FindPose(known, tolerance_px / MeanFocalLength(camera));
  if (!cam_from_shape) return std::nullopt;
  MapView view{*cam_from_shape, {}};
  for (const KnownMarker& marker : known) {
    const auto place_px = Reproject(camera, view.cam_from_shape, *marker.in_shape_m);
    if (!place_px || MaxCornerShift(*place_px, marker.corners_px) > tolerance_px) continue;
    view.departures.push_back({QuadCenter(*place_px), QuadCenter(marker.corners_px)});
  }
  const auto num_agreeing = static_cast<int>(view.departures.size());
  if (num_agreeing < kMinAgreeing || num_agreeing < kMinAgreeingPart * agreement->num_known) {
    return std::nullopt;
  }
  agreement->num_agreeing = num_agreeing;
  return view;
}

std::vector<ExpectedMarker> ExpectOnMap(const MarkerMap& map, const Camera& camera,
                                        const MapView& view, const std::vector<MarkerQuad>& found) {
  std::set<int> found_ids;
  for (const MarkerQuad& quad : found) found_ids.insert(quad.marker_id);
  std::vector<ExpectedMarker> all;
  for (const auto& [marker_id, in_shape_m] : map) {
    if (found_ids.count(marker_id) > 0) continue;
    auto corners_px = Reproject(camera, view.cam_from_shape, in_shape_m);
    if (!corners_px || !FacesCamera(*corners_px)) continue;
    const Eigen::Vector2d departure_px = LocalMotion(view.departures, QuadCenter(*corners_px));
    for (Eigen::Vector2d& corner : *corners_px) corner += departure_px;
    const double reach_px =
        4.0 + 0.3 * QuadMeanSide(*corners_px) + 0.5 * std::min(departure_px.norm(), 40.0);
    all.push_back({{marker_id, *corners_px}, reach_px});
  }
  return all;
}

}  // namespace velamap
