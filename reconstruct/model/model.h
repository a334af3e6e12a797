// A COLMAP model: cameras, posed images with their 2D points, 3D points with tracks.

#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "importer/base/ids.h"
#include "importer/camera/camera.h"
#include "importer/geometry/rigid3.h"

namespace velamap {

struct Point2D {
  Eigen::Vector2d x_in_image_px = Eigen::Vector2d::Zero();
  Point3DId point3D_id = kInvalidPoint3DId;
};

struct ModelImage {
  ImageId image_id = 0;
  CameraId camera_id = 0;
  std::string name;
  Rigid3 cam_from_world;
  // By keypoint_idx of the database. Corrected for the rolling shutter and for markers that bend if
  // the adjustment models these.
  std::vector<Point2D> points2D;
};

struct TrackElement {
  ImageId image_id = 0;
  std::uint32_t point2D_idx = 0;
};

struct Point3D {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  Rgb color{};
  double mean_error_px = 0.0;  // mean reprojection error over the track
  std::vector<TrackElement> track;
};

// The order of `images` matters: COLMAP fixes the gauge by the first two
// (reconstruct/model/gauge.h).
struct Model {
  std::map<CameraId, Camera> cameras;
  std::vector<ModelImage> images;
  std::map<Point3DId, Point3D> points3D;

  // Returns null if there is no such image.
  const ModelImage* FindImage(ImageId image_id) const;
  ModelImage* FindImage(ImageId image_id);
};

// Describes the first fault of the model in one line that names the ids; empty for a valid model. A
// model is valid if ids are unique, 2D points and track elements refer to each other, the camera of
// every image exists, rotations have unit length, and all numbers are finite. Only mean_error_px
// may be infinite: a point may lie behind its camera.
std::string FindModelFault(const Model& model);

// Throws std::logic_error if the model is not valid.
void CheckModel(const Model& model);

// Removes one observation from the track and the image. A point without observations stays until
// RemoveShortTracks.
void RemoveObservation(Model* model, Point3DId point3D_id, const TrackElement& element);

// Removes all observations of the image from the tracks. The image itself stays as it is; the
// caller removes it.
void RemoveFromTracks(const ModelImage& image, Model* model);

// Removes points with fewer than `min_track_length` observations and the references to them.
void RemoveShortTracks(Model* model, int min_track_length);

}  // namespace velamap
