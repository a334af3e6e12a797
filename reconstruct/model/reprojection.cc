#include "reconstruct/model/reprojection.h"

#include <limits>
#include <unordered_map>

namespace velamap {

std::vector<SeenPoint> SeenPointsOf(const Model& model, const ModelImage& image) {
  std::vector<SeenPoint> points;
  for (const Point2D& point2D : image.points2D) {
    const auto point = model.points3D.find(point2D.point3D_id);
    if (point == model.points3D.end()) continue;
    points.push_back({point->second.x_in_world, point2D.x_in_image_px});
  }
  return points;
}

std::vector<ObservationError> ComputeReprojectionErrors(const Model& model) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::unordered_map<ImageId, const ModelImage*> images;
  for (const ModelImage& image : model.images) images.emplace(image.image_id, &image);

  std::vector<ObservationError> errors;
  for (const auto& [point3D_id, point] : model.points3D) {
    for (const TrackElement& element : point.track) {
      const ModelImage& image = *images.at(element.image_id);
      const auto projection =
          ImageFromCam(model.cameras.at(image.camera_id), image.cam_from_world * point.x_in_world);
      ObservationError error{point3D_id, element, Eigen::Vector2d::Constant(kInfinity), kInfinity};
      if (projection) {
        error.residual_in_image_px =
            *projection - image.points2D.at(element.point2D_idx).x_in_image_px;
        error.error_px = error.residual_in_image_px.norm();
      }
      errors.push_back(error);
    }
  }
  return errors;
}

Statistics SummarizeReprojectionErrors(const Model& model) {
  std::vector<double> errors_px;
  for (const ObservationError& error : ComputeReprojectionErrors(model)) {
    errors_px.push_back(error.error_px);
  }
  return ComputeStatistics(std::move(errors_px));
}

void UpdatePointErrors(Model* model) {
  for (auto& [point3D_id, point] : model->points3D) point.mean_error_px = 0.0;
  for (const ObservationError& error : ComputeReprojectionErrors(*model)) {
    Point3D& point = model->points3D.at(error.point3D_id);
    point.mean_error_px += error.error_px / static_cast<double>(point.track.size());
  }
}

}  // namespace velamap
