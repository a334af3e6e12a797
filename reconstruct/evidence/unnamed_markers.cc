#include "reconstruct/evidence/unnamed_markers.h"

#include <algorithm>
#include <map>
#include <set>

#include "importer/base/statistics.h"

namespace velamap {
namespace {

// The median over the markers of the model of the number of images that show them.
double UsualNumImages(const Model& model) {
  std::map<int, std::size_t> num_images;
  for (const auto& [point3D_id, point] : model.points3D) {
    std::size_t& largest = num_images[CornerFromPoint3DId(point3D_id).marker_id];
    largest = std::max(largest, point.track.size());
  }
  std::vector<double> counts;
  for (const auto& [marker_id, count] : num_images) counts.push_back(static_cast<double>(count));
  return counts.empty() ? 0.0 : Median(std::move(counts));
}

// Where the centres of the model's markers project into the image, whether detected there or not,
// px.
std::vector<Eigen::Vector2d> MarkersInImage(const Model& model, const ModelImage& image) {
  std::map<int, std::vector<Eigen::Vector2d>> corners;
  for (const auto& [point3D_id, point] : model.points3D) {
    const auto corner =
        ImageFromCam(model.cameras.at(image.camera_id), image.cam_from_world * point.x_in_world);
    if (corner) corners[CornerFromPoint3DId(point3D_id).marker_id].push_back(*corner);
  }
  std::vector<Eigen::Vector2d> middles;
  for (const auto& [marker_id, of_marker] : corners) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : of_marker) sum += corner;
    middles.push_back(sum / static_cast<double>(of_marker.size()));
  }
  return middles;
}

std::vector<const MarkerDetection*> NotInLayout(const FrameDetections& detections) {
  std::vector<const MarkerDetection*> markers;
  for (const RejectedDetection& rejected : detections.rejected) {
    if (rejected.reason == kNotInLayout) markers.push_back(&rejected.detection);
  }
  return markers;
}

bool CoincidesWithAnother(const MarkerDetection& marker,
                          const std::vector<Eigen::Vector2d>& middles_px) {
  const Eigen::Vector2d middle_px = CornerMean(marker);
  const double radius_px = (marker.corners_in_image_px[0] - middle_px).norm();
  return std::any_of(middles_px.begin(), middles_px.end(), [&](const Eigen::Vector2d& other) {
    return (other - middle_px).norm() < radius_px;
  });
}

}  // namespace

std::vector<int> FindUnnamedMarkers(const std::vector<DatabaseImage>& images, const Model& model) {
  constexpr double kLeastShare = 0.25;  // of the usual number of images of a marker of the model
  constexpr std::size_t kLeastImages = 2;
  std::map<int, std::set<ImageId>> seen_in;
  for (const DatabaseImage& image : images) {
    const std::vector<const MarkerDetection*> markers = NotInLayout(image.detections);
    const ModelImage* in_model = markers.empty() ? nullptr : model.FindImage(image.image_id);
    if (in_model == nullptr) continue;
    const std::vector<Eigen::Vector2d> middles_px = MarkersInImage(model, *in_model);
    for (const MarkerDetection* marker : markers) {
      if (CoincidesWithAnother(*marker, middles_px)) continue;
      seen_in[marker->marker_id].insert(image.image_id);
    }
  }
  const double usual = UsualNumImages(model);
  std::vector<int> unnamed;
  for (const auto& [marker_id, image_ids] : seen_in) {
    const auto count = static_cast<double>(image_ids.size());
    if (image_ids.size() >= kLeastImages && count >= kLeastShare * usual) {
      unnamed.push_back(marker_id);
    }
  }
  return unnamed;
}

}  // namespace velamap
