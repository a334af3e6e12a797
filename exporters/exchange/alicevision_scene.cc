#include "exporters/exchange/alicevision_scene.h"

#include <ostream>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "importer/base/error.h"
#include "importer/base/ids.h"
#include "importer/camera/camera_projection.h"
#include "importer/text/json_text.h"

namespace velamap {
namespace {

using Json = nlohmann::ordered_json;

// AliceVision states focal lengths in mm of a sensor, which is unknown here and cancels out: the
// width of a full-frame one.
constexpr double kNominalSensorWidth_mm = 36.0;

// AliceVision's files hold every number as a string. The fewest digits that read back to the same
// value, with a decimal point in every locale.
template <typename T>
std::string NumberString(T value) {
  return fmt::format("{}", value);
}

template <typename Range>
Json NumberStrings(const Range& values) {
  Json strings = Json::array();
  for (const auto value : values) strings.push_back(NumberString(value));
  return strings;
}

struct AliceVisionDistortion {
  const char* type;
  std::vector<double> params;
};

// `k` are the camera's parameters after the principal point. AliceVision's radial and Brown models
// (camera/DistortionRadial.cpp, DistortionBrown.cpp: k1 k2 k3 t1 t2) and its fisheye4
// (DistortionFisheye.cpp) are the polynomials of OpenCV.
AliceVisionDistortion DistortionOf(CameraId camera_id, const Camera& camera) {
  const std::size_t num_before = NumFocalLengths(camera.model) + 2;
  const std::vector<double> k(camera.params.begin() + num_before, camera.params.end());
  switch (camera.model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      return {"pinhole", {}};
    case CameraModel::kSimpleRadial:
      return {"radial1", k};
    case CameraModel::kRadial:
      return {"radial3", {k[0], k[1], 0.0}};
    case CameraModel::kOpenCV:
      return {"brown", {k[0], k[1], 0.0, k[2], k[3]}};
    case CameraModel::kOpenCVFisheye:
      return {"fisheye4", k};
    case CameraModel::kFullOpenCV:
      if (k[5] == 0.0 && k[6] == 0.0 && k[7] == 0.0) {
        return {"brown", {k[0], k[1], k[4], k[2], k[3]}};
      }
  }
  throw InputError(
      fmt::format("camera {}: {} with k4, k5 or k6 has no equal in AliceVision; leave out "
                  "--alicevision, or reconstruct with another camera, such as one that "
                  "velamap camera_calibrator --camera_model OPENCV finds",
                  camera_id, CameraModelName(camera.model)));
}

Json IntrinsicJson(CameraId camera_id, const Camera& camera) {
  const std::size_t num_focal_lengths = NumFocalLengths(camera.model);
  const double fx_px = camera.params[0], fy_px = camera.params[num_focal_lengths - 1];
  const Eigen::Vector2d size_px(camera.width_px, camera.height_px);
  const Eigen::Vector2d principal_point_in_image_px(camera.params[num_focal_lengths],
                                                    camera.params[num_focal_lengths + 1]);
  // AliceVision's principal point is relative to half the size of the image, in its own pixels.
  const Eigen::Vector2d offset_px =
      (principal_point_in_image_px - 0.5 * size_px).array() - kImageFromOpenCvPx;
  const double mm_per_px = kNominalSensorWidth_mm / size_px.x();
  const AliceVisionDistortion distortion = DistortionOf(camera_id, camera);
  return {{"intrinsicId", NumberString(camera_id)},
          {"width", NumberString(camera.width_px)},
          {"height", NumberString(camera.height_px)},
          {"sensorWidth", NumberString(kNominalSensorWidth_mm)},
          {"sensorHeight", NumberString(mm_per_px * size_px.y())},
          {"serialNumber", ""},
          {"type", distortion.type},
          {"initializationMode", "calibrated"},
          {"initialFocalLength", "-1"},  // unknown: no prior for a later adjustment
          {"focalLength", NumberString(mm_per_px * fx_px)},
          {"pixelRatio", NumberString(fy_px / fx_px)},
          {"pixelRatioLocked", fx_px == fy_px ? "true" : "false"},
          {"principalPoint", NumberStrings(offset_px)},
          {"distortionInitializationMode", "none"},
          {"distortionParams", NumberStrings(distortion.params)},
          {"undistortionOffset", {"0", "0"}},
          {"undistortionParams", Json::array()},
          {"locked", "false"}};
}

// Each image is one view with a pose of its own; both have its id.
Json ViewJson(const ModelImage& image, const Camera& camera) {
  return {{"viewId", NumberString(image.image_id)},
          {"poseId", NumberString(image.image_id)},
          {"intrinsicId", NumberString(image.camera_id)},
          {"path", image.name},
          {"width", NumberString(camera.width_px)},
          {"height", NumberString(camera.height_px)},
          {"metadata", Json::object()}};
}

Json PoseJson(const ModelImage& image) {
  const Eigen::Matrix3d cam_from_world_rotation = image.cam_from_world.rotation.toRotationMatrix();
  const Eigen::Vector3d center_in_world = Inverse(image.cam_from_world).translation;
  // In column-major order.
  Json transform = {{"rotation", NumberStrings(cam_from_world_rotation.reshaped())},
                    {"center", NumberStrings(center_in_world)}};
  return {{"poseId", NumberString(image.image_id)},
          {"pose", {{"transform", std::move(transform)}, {"locked", "0"}}}};
}

Json LandmarkJson(Point3DId point3D_id, const Point3D& point, const Model& model) {
  Json observations = Json::array();
  for (const TrackElement& element : point.track) {
    const Eigen::Vector2d& corner_in_image_px =
        model.FindImage(element.image_id)->points2D.at(element.point2D_idx).x_in_image_px;
    const Eigen::Vector2d corner_in_opencv_px = corner_in_image_px.array() - kImageFromOpenCvPx;
    observations.push_back({{"observationId", NumberString(element.image_id)},
                            {"featureId", NumberString(element.point2D_idx)},
                            {"x", NumberStrings(corner_in_opencv_px)},
                            {"scale", "0"}});  // a corner has no size
  }
  return {{"landmarkId", NumberString(point3D_id)},
          {"descType", "unknown"},  // none of AliceVision's detectors
          {"color", NumberStrings(point.color)},
          {"X", NumberStrings(point.x_in_world)},
          {"observations", std::move(observations)}};
}

}  // namespace

void WriteAliceVisionScene(const Model& model, std::ostream& out) {
  Json scene = {{"version", {"1", "2", "6"}},
                {"views", Json::array()},
                {"intrinsics", Json::array()},
                {"poses", Json::array()},
                {"structure", Json::array()}};
  std::set<CameraId> camera_ids;
  for (const ModelImage& image : model.images) {
    camera_ids.insert(image.camera_id);
    scene["views"].push_back(ViewJson(image, model.cameras.at(image.camera_id)));
    scene["poses"].push_back(PoseJson(image));
  }
  for (const CameraId camera_id : camera_ids) {
    scene["intrinsics"].push_back(IntrinsicJson(camera_id, model.cameras.at(camera_id)));
  }
  for (const auto& [point3D_id, point] : model.points3D) {
    if (!IsCornerPoint3DId(point3D_id)) continue;
    scene["structure"].push_back(LandmarkJson(point3D_id, point, model));
  }
  out << JsonText(scene, 1) << '\n';
}

}  // namespace velamap
