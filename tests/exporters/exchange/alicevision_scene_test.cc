#include "exporters/exchange/alicevision_scene.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "importer/base/error.h"
#include "importer/base/numbers.h"
#include "reconstruct/model/gauge.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_model.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

// A reader of its own, after AliceVision's jsonIO.cpp and camera/*.cpp: nothing of velamap's
// cameras and poses.
double NumberOf(const nlohmann::json& string) {
  double value = NAN;
  EXPECT_TRUE(ParseNumber(string.get<std::string>(), &value)) << string;
  return value;
}

std::vector<double> NumbersOf(const nlohmann::json& strings) {
  std::vector<double> values;
  for (const nlohmann::json& string : strings) values.push_back(NumberOf(string));
  return values;
}

Eigen::Vector2d PairOf(const nlohmann::json& strings) {
  const std::vector<double> values = NumbersOf(strings);
  EXPECT_EQ(values.size(), 2u);
  return {values.at(0), values.at(1)};
}

Eigen::Vector3d TripleOf(const nlohmann::json& strings) {
  const std::vector<double> values = NumbersOf(strings);
  EXPECT_EQ(values.size(), 3u);
  return {values.at(0), values.at(1), values.at(2)};
}

// The elements of an array by the number that they have under `key`.
std::map<int, nlohmann::json> ById(const nlohmann::json& array, const char* key) {
  std::map<int, nlohmann::json> element_of_id;
  for (const nlohmann::json& element : array) {
    const int id = static_cast<int>(NumberOf(element.at(key)));
    EXPECT_TRUE(element_of_id.emplace(id, element).second) << key << " " << id;
  }
  return element_of_id;
}

// `ray` is (x/z, y/z) in AliceVision's camera: x right, y down, z forward.
Eigen::Vector2d DistortAsAliceVision(const nlohmann::json& intrinsic, const Eigen::Vector2d& ray) {
  const std::string type = intrinsic.at("type");
  const std::vector<double> k = NumbersOf(intrinsic.at("distortionParams"));
  const double x = ray.x(), y = ray.y(), r2 = x * x + y * y, r = std::sqrt(r2);
  if (type == "pinhole") {
    EXPECT_EQ(k.size(), 0u);
    return ray;
  }
  if (type == "radial1") {
    EXPECT_EQ(k.size(), 1u);
    return ray * (1 + k.at(0) * r2);
  }
  if (type == "fisheye4") {
    EXPECT_EQ(k.size(), 4u);
    const double theta = std::atan(r);
    double distorted_theta = theta;
    for (int i = 0; i < 4; ++i) distorted_theta += k.at(i) * std::pow(theta, 2 * i + 3);
    return ray * distorted_theta / r;
  }
  const Eigen::Vector2d radial =
      ray * (1 + k.at(0) * r2 + k.at(1) * std::pow(r, 4) + k.at(2) * std::pow(r, 6));
  if (type == "radial3") {
    EXPECT_EQ(k.size(), 3u);
    return radial;
  }
  EXPECT_EQ(type, "brown");
  EXPECT_EQ(k.size(), 5u);
  const double t1 = k.at(3), t2 = k.at(4);
  return radial + Eigen::Vector2d(t2 * (r2 + 2 * x * x) + 2 * t1 * x * y,
                                  t1 * (r2 + 2 * y * y) + 2 * t2 * x * y);
}

// In AliceVision's pixels.
Eigen::Vector2d ProjectAsAliceVision(const nlohmann::json& intrinsic, const nlohmann::json& pose,
                                     const Eigen::Vector3d& x_in_world) {
  const nlohmann::json& transform = pose.at("pose").at("transform");
  const std::vector<double> columns = NumbersOf(transform.at("rotation"));
  EXPECT_EQ(columns.size(), 9u);
  const Eigen::Vector3d x_in_cam = Eigen::Map<const Eigen::Matrix3d>(columns.data()) *
                                   (x_in_world - TripleOf(transform.at("center")));
  EXPECT_GT(x_in_cam.z(), 0.0);
  const double width_px = NumberOf(intrinsic.at("width"));
  const double fx_px =
      NumberOf(intrinsic.at("focalLength")) / NumberOf(intrinsic.at("sensorWidth")) * width_px;
  const Eigen::Vector2d focal_px(fx_px, fx_px * NumberOf(intrinsic.at("pixelRatio")));
  const Eigen::Vector2d half_size_px(0.5 * width_px, 0.5 * NumberOf(intrinsic.at("height")));
  return DistortAsAliceVision(intrinsic, x_in_cam.hnormalized()).cwiseProduct(focal_px) +
         half_size_px + PairOf(intrinsic.at("principalPoint"));
}

// Every model of a camera that AliceVision has too; no two parameters are alike.
std::vector<Camera> CamerasOfAliceVision() {
  return {{CameraModel::kSimplePinhole, 1920, 1080, {1500, 955, 545}},
          {CameraModel::kPinhole, 1920, 1080, {1500, 1490, 955, 545}},
          {CameraModel::kSimpleRadial, 1920, 1080, {1500, 955, 545, -0.2}},
          {CameraModel::kRadial, 1080, 1920, {1500, 545, 955, -0.2, 0.07}},
          {CameraModel::kOpenCV, 1920, 1080, {1500, 1490, 955, 545, -0.2, 0.07, 0.003, -0.002}},
          {CameraModel::kOpenCVFisheye, 1920, 1080, {900, 905, 955, 545, 0.1, -0.05, 0.02, 0.01}},
          {CameraModel::kFullOpenCV,
           1920,
           1080,
           {1500, 1490, 955, 545, -0.2, 0.07, 0.003, -0.002, 0.04, 0, 0, 0}}};
}

// The example without noise, seen by this camera, in a world turned about no axis of its own, so
// that no rotation is symmetric.
Model ModelSeenBy(const Camera& camera) {
  Model model = ExampleModel();
  TransformModel(ExampleSim3(1.0), &model);
  model.cameras.at(1) = camera;
  for (ModelImage& image : model.images) {
    for (Point2D& point : image.points2D) {
      const Eigen::Vector3d& x_in_world = model.points3D.at(point.point3D_id).x_in_world;
      point.x_in_image_px = ImageFromCam(camera, image.cam_from_world * x_in_world).value();
    }
  }
  return model;
}

std::string AliceVisionText(const Model& model) {
  return Written([&](std::ostream& out) { WriteAliceVisionScene(model, out); });
}

TEST(AliceVisionScene, EveryCameraSeesTheLandmarksWhereTheyWereObserved) {
  for (const Camera& camera : CamerasOfAliceVision()) {
    SCOPED_TRACE(CameraModelName(camera.model));
    const Model model = ModelSeenBy(camera);
    const auto scene = nlohmann::json::parse(AliceVisionText(model));
    EXPECT_EQ(TripleOf(scene.at("version")), Eigen::Vector3d(1, 2, 6));
    const auto views = ById(scene.at("views"), "viewId");
    const auto intrinsics = ById(scene.at("intrinsics"), "intrinsicId");
    const auto poses = ById(scene.at("poses"), "poseId");
    EXPECT_EQ(views.size(), model.images.size());
    const auto landmarks = ById(scene.at("structure"), "landmarkId");
    ASSERT_EQ(landmarks.size(), model.points3D.size());
    for (const auto& [landmark_id, landmark] : landmarks) {
      const Eigen::Vector3d x_in_world = TripleOf(landmark.at("X"));
      const auto observations = ById(landmark.at("observations"), "observationId");
      EXPECT_EQ(observations.size(), model.images.size());
      for (const auto& [view_id, observation] : observations) {
        const nlohmann::json& view = views.at(view_id);
        const nlohmann::json& intrinsic =
            intrinsics.at(static_cast<int>(NumberOf(view.at("intrinsicId"))));
        const nlohmann::json& pose = poses.at(static_cast<int>(NumberOf(view.at("poseId"))));
        const Eigen::Vector2d seen_px = ProjectAsAliceVision(intrinsic, pose, x_in_world);
        EXPECT_LT((seen_px - PairOf(observation.at("x"))).norm(), 1e-6)
            << landmark_id << " in " << view_id;
      }
    }
  }
}

// AliceVision's pixels are half a pixel less than COLMAP's; all else is as in the model.
TEST(AliceVisionScene, HoldsTheModelUnderItsNames) {
  Model model = ModelSeenBy({CameraModel::kPinhole, 1920, 1080, {1500, 1490, 960, 540}});
  model.images[1].name = "port/\"2\".jpg";
  const auto scene = nlohmann::json::parse(AliceVisionText(model));
  const auto landmarks = ById(scene.at("structure"), "landmarkId");
  for (const auto& [point3D_id, point] : model.points3D) {
    const nlohmann::json& landmark = landmarks.at(static_cast<int>(point3D_id));
    EXPECT_EQ(TripleOf(landmark.at("X")), point.x_in_world);
    EXPECT_EQ(TripleOf(landmark.at("color")),
              Eigen::Vector3d(point.color[0], point.color[1], point.color[2]));
    const auto observations = ById(landmark.at("observations"), "observationId");
    for (const TrackElement& element : point.track) {
      const Point2D& point2D = model.FindImage(element.image_id)->points2D.at(element.point2D_idx);
      const nlohmann::json& observation = observations.at(static_cast<int>(element.image_id));
      EXPECT_EQ(NumberOf(observation.at("featureId")), element.point2D_idx);
      EXPECT_EQ(PairOf(observation.at("x")),
                point2D.x_in_image_px - Eigen::Vector2d::Constant(0.5));
    }
  }
  const auto views = ById(scene.at("views"), "viewId");
  for (const ModelImage& image : model.images) {
    EXPECT_EQ(views.at(static_cast<int>(image.image_id)).at("path"), image.name);
  }
  ASSERT_EQ(scene.at("intrinsics").size(), 1u);
  EXPECT_EQ(PairOf(scene.at("intrinsics")[0].at("principalPoint")), Eigen::Vector2d(-0.5, -0.5));
}

TEST(AliceVisionScene, OtherPointsAndUnusedCamerasAreLeftOut) {
  Model model = ExampleModel();
  const std::string text = AliceVisionText(model);
  model.points3D[17];
  model.cameras[2] = {CameraModel::kFullOpenCV, 4, 4, {1, 1, 2, 2, 0, 0, 0, 0, 0, 0.1, 0, 0}};
  EXPECT_EQ(AliceVisionText(model), text);
}

TEST(AliceVisionScene, LocaleChangesNoByte) {
  const Model model = ModelSeenBy(CamerasOfAliceVision().back());
  const std::string text = AliceVisionText(model);
  const CommaLocale comma_locale;
  EXPECT_EQ(AliceVisionText(model), text);
}

TEST(AliceVisionScene, ARationalCameraIsRefused) {
  for (int i = 9; i < 12; ++i) {
    Camera camera = CamerasOfAliceVision().back();
    camera.params.at(i) = 0.01;
    ExpectThrows<InputError>([&] { AliceVisionText(ModelSeenBy(camera)); },
                             {"camera 1: FULL_OPENCV", "leave out --alicevision"});
  }
}

}  // namespace
}  // namespace velamap
