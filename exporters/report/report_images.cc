#include <cmath>
#include <filesystem>
#include <set>

#include "exporters/report/report_json.h"
#include "exporters/report/report_picture.h"

namespace velamap {
namespace {

constexpr int kMaxPictureSide_px = 1600;

// Directions of the image's corners in the shape frame at depth 1: top-left, top-right,
// bottom-right, bottom-left, without distortion.
ReportJsonValue FrustumJson(const Camera& camera, const Rigid3& world_from_cam) {
  const double f = MeanFocalLength(camera);
  const double x = 0.5 * camera.width_px / f, y = 0.5 * camera.height_px / f;
  ReportJsonValue frustum = ReportJsonValue::array();
  for (const Eigen::Vector3d& ray : {Eigen::Vector3d(-x, -y, 1), Eigen::Vector3d(x, -y, 1),
                                     Eigen::Vector3d(x, y, 1), Eigen::Vector3d(-x, y, 1)}) {
    frustum.push_back(VectorJson(world_from_cam.rotation * ray));
  }
  return frustum;
}

void AddErrors(const ImageMetrics& metrics, ReportJsonValue* json) {
  (*json)["num_markers"] = metrics.num_markers;
  if (metrics.marker_ratio) (*json)["marker_ratio"] = *metrics.marker_ratio;
  (*json)["num_corners"] = metrics.error_px.count;
  if (metrics.error_px.count == 0) return;
  (*json)["error_mean_px"] = metrics.error_px.mean;
  (*json)["error_rms_px"] = metrics.error_px.rms;
  (*json)["error_max_px"] = metrics.error_px.max;
}

// Where the corners of a marker would be seen; nothing if one is outside the image, or if the
// marker faces away.
std::optional<ReportJsonValue> CornersInImage(const ShapeMarker& marker, const ModelImage& image,
                                              const Camera& camera) {
  const Eigen::Vector3d center_in_cam = image.cam_from_world * *marker.x_in_shape_m[0];
  if ((image.cam_from_world.rotation * MarkerNormal(marker)).dot(center_in_cam) >= 0) {
    return std::nullopt;
  }
  ReportJsonValue corners = ReportJsonValue::array();
  for (int corner = 1; corner <= kNumCorners; ++corner) {
    const auto x = ImageFromCam(camera, image.cam_from_world * *marker.x_in_shape_m[corner]);
    if (!x || x->minCoeff() < 0 || x->x() > camera.width_px || x->y() > camera.height_px) {
      return std::nullopt;
    }
    corners.push_back({x->x(), x->y()});
  }
  return corners;
}

// Whole markers that should be visible in the image, but have no observation in it.
ReportJsonValue NotDetectedJson(const MarkerShape& shape, const ModelImage& image,
                                const Camera& camera) {
  std::set<int> detected;
  for (const Point2D& point : image.points2D) {
    if (!IsCornerPoint3DId(point.point3D_id)) continue;
    detected.insert(CornerFromPoint3DId(point.point3D_id).marker_id);
  }
  ReportJsonValue all = ReportJsonValue::array();
  for (const ShapeMarker& marker : shape.markers) {
    if (!marker.IsWhole() || detected.count(marker.marker_id) > 0) continue;
    if (auto corners = CornersInImage(marker, image, camera)) {
      all.push_back({{"id", marker.marker_id}, {"corners", std::move(*corners)}});
    }
  }
  return all;
}

}  // namespace

ReportJsonValue ImagesJson(const ReportInput& input) {
  std::map<std::string, const ModelImage*> images;
  for (const ModelImage& image : input.metric_model.images) images[image.name] = &image;
  ReportJsonValue all = ReportJsonValue::array();
  for (const ImageMetrics& metrics : input.model_metrics.images) {
    ReportJsonValue json = {{"name", metrics.image_name}};
    if (metrics.image_name == input.model_metrics.central_image_name) json["central"] = true;
    AddErrors(metrics, &json);
    const auto found = images.find(metrics.image_name);
    if (found != images.end()) {
      const ModelImage& image = *found->second;
      const Rigid3 world_from_cam = Inverse(image.cam_from_world);
      json["centre"] = VectorJson(world_from_cam.translation);
      json["frustum"] = FrustumJson(input.metric_model.cameras.at(image.camera_id), world_from_cam);
    }
    all.push_back(std::move(json));
  }
  return all;
}

ReportJsonValue PictureJson(const ReportInput& input, const std::vector<ObservationError>& errors) {
  const ModelImage& image = input.metric_model.images.front();
  const Camera& camera = input.metric_model.cameras.at(image.camera_id);
  ReportJsonValue json = {
      {"name", image.name}, {"width_px", camera.width_px}, {"height_px", camera.height_px}};
  ReportPicture picture;
  if (input.image_path.empty()) {
    picture.problem = "the report was made without the folder of the images";
  } else {
    picture = MakeReportPicture((std::filesystem::path(input.image_path) / image.name).string(),
                                kMaxPictureSide_px);
  }
  if (picture.problem.empty()) {
    json["jpeg"] = std::move(picture.jpeg_base64);
  } else {
    json["problem"] = picture.problem;
  }
  // Point id, detected x y, residual x y.
  ReportJsonValue points = ReportJsonValue::array();
  for (const ObservationError& error : errors) {
    if (error.element.image_id != image.image_id || !std::isfinite(error.error_px)) continue;
    const Eigen::Vector2d& x = image.points2D.at(error.element.point2D_idx).x_in_image_px;
    points.push_back({error.point3D_id, x.x(), x.y(), error.residual_in_image_px.x(),
                      error.residual_in_image_px.y()});
  }
  json["points"] = std::move(points);
  json["rejected"] = ReportJsonValue::array();
  for (const Point2D& point : image.points2D) {
    if (point.point3D_id != kInvalidPoint3DId) continue;
    json["rejected"].push_back({point.x_in_image_px.x(), point.x_in_image_px.y()});
  }
  json["not_detected"] = NotDetectedJson(input.shape, image, camera);
  return json;
}

}  // namespace velamap
