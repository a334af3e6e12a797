#include "reconstruct/colmap/observation_filter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "importer/base/error.h"
#include "reconstruct/model/reprojection.h"

namespace velamap {
namespace {

constexpr int kMinImageObservations = 4;

// Residuals along both axes, px.
using AxisResiduals = std::vector<double>;

void AddResidual(const ObservationError& error, AxisResiduals* residuals) {
  if (!std::isfinite(error.error_px)) return;
  residuals->push_back(error.residual_in_image_px.x());
  residuals->push_back(error.residual_in_image_px.y());
}

double OutlierThreshold(const BundleAdjustmentOptions& options, double sigma_px) {
  return std::max(options.min_outlier_error_px, options.outlier_ratio * sigma_px);
}

void Remove(const ObservationError& error, Model* model, std::vector<RemovedObservation>* removed) {
  RemoveObservation(model, error.point3D_id, error.element);
  removed->push_back({error.point3D_id, error.element, error.error_px});
}

// Outliers among the observations of one point. A gross outlier shifts the point and increases the
// errors of good observations. Therefore only observations with errors of similar size are removed
// with it. If these are the majority, it is removed alone, and the next round decides on the
// others. Observations of points behind the camera are all removed, because COLMAP would drop them.
std::vector<ObservationError> FindOutliers(const std::vector<ObservationError>& track,
                                           double threshold_px) {
  constexpr double kFractionOfWorst = 0.3;
  const auto less = [](const ObservationError& a, const ObservationError& b) {
    return a.error_px < b.error_px;
  };
  const auto worst = std::max_element(track.begin(), track.end(), less);
  if (worst->error_px <= threshold_px) return {};
  std::vector<ObservationError> outliers;
  for (const ObservationError& error : track) {
    if (error.error_px > std::max(threshold_px, kFractionOfWorst * worst->error_px) ||
        std::isinf(error.error_px)) {
      outliers.push_back(error);
    }
  }
  const bool is_dragged = 2 * outliers.size() > track.size();
  return is_dragged && std::isfinite(worst->error_px) ? std::vector{*worst} : outliers;
}

int RestoreFitting(double threshold_px, Model* model, std::vector<RemovedObservation>* removed) {
  const auto restored = std::stable_partition(removed->begin(), removed->end(),
                                              [threshold_px, model](const RemovedObservation& o) {
                                                return !RestoreObservation(o, threshold_px, model);
                                              });
  const auto num_restored = removed->end() - restored;
  removed->erase(restored, removed->end());
  return static_cast<int>(num_restored);
}

bool HasFewObservations(const ModelImage& image) {
  return std::count_if(image.points2D.begin(), image.points2D.end(), [](const Point2D& point2D) {
           return point2D.point3D_id != kInvalidPoint3DId;
         }) < kMinImageObservations;
}

}  // namespace

void RemoveSeedOutliers(const BundleAdjustmentOptions& options, Model* model,
                        std::vector<RemovedObservation>* removed) {
  const std::vector<ObservationError> errors = ComputeReprojectionErrors(*model);
  AxisResiduals all;
  std::map<ImageId, AxisResiduals> by_image;
  std::map<Point3DId, AxisResiduals> by_point;
  for (const ObservationError& error : errors) {
    AddResidual(error, &all);
    AddResidual(error, &by_image[error.element.image_id]);
    AddResidual(error, &by_point[error.point3D_id]);
  }
  const double model_sigma_px = RobustSigmaAboutZero(std::move(all));
  std::map<ImageId, double> image_sigma_px;
  for (const auto& [image_id, residuals] : by_image) {
    image_sigma_px[image_id] = RobustSigmaAboutZero(residuals);
  }
  std::map<Point3DId, double> point_sigma_px;
  for (const auto& [point3D_id, residuals] : by_point) {
    point_sigma_px[point3D_id] = RobustSigmaAboutZero(residuals);
  }
  for (const ObservationError& error : errors) {
    const double sigma_px = std::max({model_sigma_px, image_sigma_px.at(error.element.image_id),
                                      point_sigma_px.at(error.point3D_id)});
    if (std::isfinite(error.error_px) && error.error_px <= OutlierThreshold(options, sigma_px)) {
      continue;
    }
    Remove(error, model, removed);
  }
}

int ReviseObservations(const BundleAdjustmentOptions& options, Model* model,
                       std::vector<RemovedObservation>* removed) {
  std::map<Point3DId, std::vector<ObservationError>> tracks;
  AxisResiduals residuals;
  for (const ObservationError& error : ComputeReprojectionErrors(*model)) {
    tracks[error.point3D_id].push_back(error);
    AddResidual(error, &residuals);
  }
  if (residuals.empty()) return 0;
  const double threshold_px = OutlierThreshold(options, RobustSigma(residuals));
  // Comes first, because observations that are removed below must not be restored.
  int num_changes = RestoreFitting(threshold_px, model, removed);
  for (const auto& [point3D_id, track] : tracks) {
    for (const ObservationError& outlier : FindOutliers(track, threshold_px)) {
      Remove(outlier, model, removed);
      ++num_changes;
    }
  }
  return num_changes;
}

bool RemoveUnprovenCorners(Model* model, std::vector<RemovedObservation>* removed) {
  std::map<int, int> num_corners;
  for (const auto& [point3D_id, point] : model->points3D) {
    ++num_corners[CornerFromPoint3DId(point3D_id).marker_id];
  }
  const auto is_unproven = [&](const ObservationError& error) {
    return num_corners[CornerFromPoint3DId(error.point3D_id).marker_id] < kNumCorners &&
           model->points3D.at(error.point3D_id).track.size() <= 2;
  };
  std::vector<ObservationError> unproven = ComputeReprojectionErrors(*model);
  unproven.erase(std::remove_if(unproven.begin(), unproven.end(), std::not_fn(is_unproven)),
                 unproven.end());
  for (const ObservationError& error : unproven) Remove(error, model, removed);
  return !unproven.empty();
}

bool RestoreObservation(const RemovedObservation& observation, double max_error_px, Model* model) {
  const auto point = model->points3D.find(observation.point3D_id);
  ModelImage* image = model->FindImage(observation.element.image_id);
  if (point == model->points3D.end() || image == nullptr) return false;
  Point2D& point2D = image->points2D.at(observation.element.point2D_idx);
  const auto projection = ImageFromCam(model->cameras.at(image->camera_id),
                                       image->cam_from_world * point->second.x_in_world);
  if (!projection || !((*projection - point2D.x_in_image_px).norm() <= max_error_px)) return false;
  VELAMAP_CHECK(point2D.point3D_id == kInvalidPoint3DId);
  point2D.point3D_id = observation.point3D_id;
  point->second.track.push_back(observation.element);
  return true;
}

void RemoveUnderconstrained(int min_track_length, Model* model,
                            std::vector<ImageId>* removed_images) {
  while (true) {
    RemoveShortTracks(model, min_track_length);
    const auto first_removed =
        std::stable_partition(model->images.begin(), model->images.end(),
                              [](const ModelImage& image) { return !HasFewObservations(image); });
    if (first_removed == model->images.end()) return;
    for (auto image = first_removed; image != model->images.end(); ++image) {
      RemoveFromTracks(*image, model);
      removed_images->push_back(image->image_id);
    }
    model->images.erase(first_removed, model->images.end());
  }
}

void CheckEnough(const Model& model, std::size_t num_images_before, std::size_t num_outliers) {
  if (model.images.size() >= 2 && !model.points3D.empty()) return;
  throw DataError(fmt::format(
      "nothing is left to adjust: {} of {} images share enough corners with others ({} outliers "
      "removed); take more pictures that show the same markers",
      model.images.size(), num_images_before, num_outliers));
}

}  // namespace velamap
