#include "reconstruct/model/model.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "importer/base/error.h"

namespace velamap {
namespace {

using ImagesById = std::unordered_map<ImageId, const ModelImage*>;

// Squares and products of larger coordinates leave the range of numbers.
constexpr double kMaxCoordinate = 1e12;

std::string FindCameraFault(CameraId camera_id, const Camera& camera) {
  if (camera.width_px <= 0 || camera.height_px <= 0) {
    return fmt::format("camera {} has the size {} x {}", camera_id, camera.width_px,
                       camera.height_px);
  }
  if (static_cast<int>(camera.params.size()) != NumCameraParams(camera.model)) {
    return fmt::format("camera {} has {} parameters, {} takes {}", camera_id, camera.params.size(),
                       CameraModelName(camera.model), NumCameraParams(camera.model));
  }
  if (!std::all_of(camera.params.begin(), camera.params.end(),
                   [](double param) { return std::isfinite(param); })) {
    return fmt::format("camera {} has a parameter that is not finite", camera_id);
  }
  if (!(SmallestFocalLength(camera) > 0)) {
    return fmt::format("camera {} has a focal length that is not positive", camera_id);
  }
  return "";
}

// Checks the references from images to points. FindUntrackedObservation() checks the way back; as
// every track element is valid and unique, it only compares numbers of observations.
std::string FindImageFault(const Model& model, const ModelImage& image) {
  if (model.cameras.count(image.camera_id) == 0) {
    return fmt::format("image {} has camera {}, which does not exist", image.image_id,
                       image.camera_id);
  }
  constexpr double kMaxNormError = 1e-6;
  if (!image.cam_from_world.translation.allFinite() ||
      !(std::abs(image.cam_from_world.rotation.norm() - 1.0) <= kMaxNormError)) {
    return fmt::format(
        "image {} has a pose that is not finite or whose rotation is not a unit "
        "quaternion",
        image.image_id);
  }
  if (image.cam_from_world.translation.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    return fmt::format("image {} has a translation beyond {:g}", image.image_id, kMaxCoordinate);
  }
  for (std::size_t idx = 0; idx < image.points2D.size(); ++idx) {
    const Point2D& point2D = image.points2D[idx];
    if (!point2D.x_in_image_px.allFinite()) {
      return fmt::format("2D point {} of image {} is not finite", idx, image.image_id);
    }
    if (point2D.point3D_id != kInvalidPoint3DId && model.points3D.count(point2D.point3D_id) == 0) {
      return fmt::format("2D point {} of image {} observes point {}, which does not exist", idx,
                         image.image_id, point2D.point3D_id);
    }
  }
  return "";
}

std::string FindPointFault(const ImagesById& images, Point3DId point3D_id, const Point3D& point) {
  if (!point.x_in_world.allFinite()) return fmt::format("point {} is not finite", point3D_id);
  if (point.x_in_world.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    return fmt::format("point {} has a coordinate beyond {:g}", point3D_id, kMaxCoordinate);
  }
  if (std::isnan(point.mean_error_px)) {
    return fmt::format("the error of point {} is not a number", point3D_id);
  }
  std::set<std::pair<ImageId, std::uint32_t>> elements;
  for (const TrackElement& element : point.track) {
    const auto image = images.find(element.image_id);
    if (image == images.end()) {
      return fmt::format("the track of point {} has image {}, which does not exist", point3D_id,
                         element.image_id);
    }
    const std::vector<Point2D>& points2D = image->second->points2D;
    if (element.point2D_idx >= points2D.size() ||
        points2D[element.point2D_idx].point3D_id != point3D_id) {
      return fmt::format(
          "the track of point {} has 2D point {} of image {}, which does not "
          "observe it",
          point3D_id, element.point2D_idx, element.image_id);
    }
    if (!elements.insert({element.image_id, element.point2D_idx}).second) {
      return fmt::format("the track of point {} has 2D point {} of image {} twice", point3D_id,
                         element.point2D_idx, element.image_id);
    }
  }
  return "";
}

std::string FindUntrackedObservation(const Model& model) {
  std::unordered_map<Point3DId, std::size_t> num_observations;
  for (const ModelImage& image : model.images) {
    for (const Point2D& point2D : image.points2D) ++num_observations[point2D.point3D_id];
  }
  for (const auto& [point3D_id, point] : model.points3D) {
    if (num_observations[point3D_id] != point.track.size()) {
      return fmt::format("point {} is observed by {} 2D points, but its track has {}", point3D_id,
                         num_observations[point3D_id], point.track.size());
    }
  }
  return "";
}

}  // namespace

const ModelImage* Model::FindImage(ImageId image_id) const {
  const auto it = std::find_if(images.begin(), images.end(), [image_id](const ModelImage& image) {
    return image.image_id == image_id;
  });
  return it == images.end() ? nullptr : &*it;
}

ModelImage* Model::FindImage(ImageId image_id) {
  return const_cast<ModelImage*>(std::as_const(*this).FindImage(image_id));
}

std::string FindModelFault(const Model& model) {
  for (const auto& [camera_id, camera] : model.cameras) {
    const std::string fault = FindCameraFault(camera_id, camera);
    if (!fault.empty()) return fault;
  }
  ImagesById images;
  for (const ModelImage& image : model.images) {
    if (!images.emplace(image.image_id, &image).second) {
      return fmt::format("there are two images with the id {}", image.image_id);
    }
    const std::string fault = FindImageFault(model, image);
    if (!fault.empty()) return fault;
  }
  for (const auto& [point3D_id, point] : model.points3D) {
    const std::string fault = FindPointFault(images, point3D_id, point);
    if (!fault.empty()) return fault;
  }
  return FindUntrackedObservation(model);
}

void CheckModel(const Model& model) {
  const std::string fault = FindModelFault(model);
  if (!fault.empty()) throw std::logic_error("broken model: " + fault);
}

void RemoveObservation(Model* model, Point3DId point3D_id, const TrackElement& element) {
  std::vector<TrackElement>& track = model->points3D.at(point3D_id).track;
  const auto it = std::find_if(track.begin(), track.end(), [&element](const TrackElement& other) {
    return other.image_id == element.image_id && other.point2D_idx == element.point2D_idx;
  });
  ModelImage* image = model->FindImage(element.image_id);
  VELAMAP_CHECK(it != track.end() && image != nullptr);
  image->points2D.at(element.point2D_idx).point3D_id = kInvalidPoint3DId;
  track.erase(it);
}

void RemoveFromTracks(const ModelImage& image, Model* model) {
  for (const Point2D& point2D : image.points2D) {
    if (point2D.point3D_id == kInvalidPoint3DId) continue;
    std::vector<TrackElement>& track = model->points3D.at(point2D.point3D_id).track;
    track.erase(std::remove_if(track.begin(), track.end(),
                               [&image](const TrackElement& element) {
                                 return element.image_id == image.image_id;
                               }),
                track.end());
  }
}

void RemoveShortTracks(Model* model, int min_track_length) {
  const auto is_short = [min_track_length](const Point3D& point) {
    return static_cast<int>(point.track.size()) < min_track_length;
  };
  for (ModelImage& image : model->images) {
    for (Point2D& point2D : image.points2D) {
      const auto point = model->points3D.find(point2D.point3D_id);
      if (point != model->points3D.end() && is_short(point->second)) {
        point2D.point3D_id = kInvalidPoint3DId;
      }
    }
  }
  for (auto it = model->points3D.begin(); it != model->points3D.end();) {
    it = is_short(it->second) ? model->points3D.erase(it) : std::next(it);
  }
}

}  // namespace velamap
