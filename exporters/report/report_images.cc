#include <algorithm>
#include <cmath>
#include <filesystem>

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
  return json;
}

}  // namespace velamap
