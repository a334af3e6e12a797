#include "reconstruct/camera_search.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "importer/camera/turned_camera.h"
#include "reconstruct/adjust/camera_adjustment.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"
#include "tests/reconstruct/registration_fixture.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

constexpr double kSearchNoisePx = 0.1;

SyntheticScene MakeScene(SceneKind kind, const Camera& camera, std::uint32_t seed) {
  SyntheticSceneOptions options;
  options.kind = kind;
  options.num_rows = 4;
  options.num_columns = 5;
  options.num_frames = 16;
  options.camera = camera;
  options.seed = seed;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({kSearchNoisePx, 0, 0, 200, seed}, &scene);
  return scene;
}

struct Found {
  Camera camera;
  EstimatedCamera estimate;
  std::map<CameraId, Camera> all;
};

Found Find(const std::vector<DatabaseImage>& images, const std::map<CameraId, Camera>& guesses,
           const Layout& layout, double inset_sigma_px = 0.0) {
  MarkerAdjustmentOptions adjustment;
  adjustment.find_camera = true;
  adjustment.inset_sigma_px = inset_sigma_px;
  const CornerErrors sigmas = CornerErrorsOf(images);
  Found found;
  found.all = FindCameras(images, guesses, layout, sigmas, {}, adjustment);
  const Registration registration = RegisterFrames(images, found.all, layout, {});
  Model model = MakeSeedModel(registration, images, found.all);
  const auto summary = AdjustWithMarkers(adjustment, layout, sigmas, &model);
  found.estimate = summary.cameras.begin()->second;
  found.camera = found.estimate.camera;
  return found;
}

Found Find(const SyntheticScene& scene) {
  return Find(DatabaseImages(scene),
              {{1, UnknownCamera(scene.camera.width_px, scene.camera.height_px)}}, scene.layout);
}

// Relative.
double FocalError(const Found& found, const Camera& truth) {
  return MeanFocalLength(found.camera) / MeanFocalLength(truth) - 1.0;
}

TEST(CameraSearch, DrawnCamerasAreFoundWithinTheirSigmas) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double sum = 0.0;
  constexpr int kNumDraws = 8;
  for (std::uint32_t draw = 0; draw < kNumDraws; ++draw) {
    const double focal_px = 1920 * (0.5 + 1.1 * unit(generator));
    const double k1 = -0.2 * unit(generator) * std::pow(focal_px / 1920, 2);
    const Camera truth{CameraModel::kOpenCV,
                       1920,
                       1080,
                       {focal_px, focal_px, 950 + 20 * unit(generator), 530 + 20 * unit(generator),
                        k1, 0.2 * k1 * k1, 0, 0}};
    const Found found = Find(MakeScene(SceneKind::kSail, truth, draw + 1));
    const double error = FocalError(found, truth);
    const double sigma = found.estimate.sigmas.front() / focal_px;
    EXPECT_LT(std::abs(error), std::max(0.004, 4.0 * sigma)) << draw;
    EXPECT_LT(sigma, 0.02) << draw;
    sum += std::pow(error / sigma, 2);
  }
  EXPECT_LT(sum / kNumDraws, 3.3);  // 99.9 % of chi-squared with 8 degrees of freedom
}

// Squares that are seen too small seem to be foreshortened otherwise than they are.
TEST(CameraSearch, AnInsetOfAllCornersIsInTheSigmaOfTheFocalLength) {
  constexpr double kInsetPx = 0.2;
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 964, 537, -0.05}};
  SyntheticScene scene = MakeScene(SceneKind::kSail, truth, 5);
  AddInset([](const MarkerDetection&) { return kInsetPx; }, &scene);
  const std::vector<DatabaseImage> images = DatabaseImages(scene);
  const std::map<CameraId, Camera> guesses = {{1, UnknownCamera(1920, 1080)}};
  const Found unaware = Find(images, guesses, scene.layout);
  const Found aware = Find(images, guesses, scene.layout, kInsetPx);
  EXPECT_GT(aware.estimate.sigmas.front(), 1.3 * unaware.estimate.sigmas.front());
  EXPECT_LT(std::abs(FocalError(aware, truth)),
            3.0 * aware.estimate.sigmas.front() / MeanFocalLength(truth));
}

TEST(CameraSearch, AFisheyeIsFoundAsOne) {
  const Camera truth{
      CameraModel::kOpenCVFisheye, 1920, 1080, {760, 760, 965, 536, 0.03, -0.01, 0.002, 0}};
  const Found found = Find(MakeScene(SceneKind::kSail, truth, 3));
  EXPECT_EQ(found.camera.model, CameraModel::kOpenCVFisheye);
  EXPECT_NEAR(FocalError(found, truth), 0.0, 0.01);
}

TEST(CameraSearch, AStraightLensNeedsNoManyParameters) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 964, 537, -0.05}};
  const Found found = Find(MakeScene(SceneKind::kSail, truth, 5));
  EXPECT_EQ(found.camera.model, CameraModel::kSimpleRadial);
}

// A tangential distortion, which SIMPLE_RADIAL does not have, passes for a shift of the principal
// point. The focal length hardly depends on either.
TEST(CameraSearch, ATangentialDistortionThatIsLeftOutIsInTheSigmasOfThePrincipalPoint) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 964, 537, -0.05}};
  const std::vector<DatabaseImage> images = DatabaseImages(MakeScene(SceneKind::kSail, truth, 5));
  const Layout layout = MakeScene(SceneKind::kSail, truth, 5).layout;
  MarkerAdjustmentOptions adjustment;
  adjustment.find_camera = true;
  const auto sigmas_as = [&](const Camera& camera) {
    const std::map<CameraId, Camera> cameras = {{1, camera}};
    Model model = MakeSeedModel(RegisterFrames(images, cameras, layout, {}), images, cameras);
    return AdjustWithMarkers(adjustment, layout, CornerErrorsOf(images), &model)
        .cameras.at(1)
        .sigmas;
  };
  const std::vector<double> few = sigmas_as(truth);
  const std::vector<double> all =
      sigmas_as({CameraModel::kOpenCV, 1920, 1080, {1500, 1500, 964, 537, -0.05, 0, 0, 0}});
  EXPECT_NEAR(few[1] / all[2], 1.0, 0.1);
  EXPECT_NEAR(few[2] / all[3], 1.0, 0.1);
  EXPECT_LT(few[0], 1.01 * all[0]);
}

TEST(CameraSearch, AFalseClaimOfExifDoesNoHarm) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1300, 960, 540, -0.05}};
  const SyntheticScene scene = MakeScene(SceneKind::kSail, truth, 10);
  const Found found =
      Find(DatabaseImages(scene), {{1, UnknownCamera(1920, 1080, 5200)}}, scene.layout);
  EXPECT_NEAR(FocalError(found, truth), 0.0, 0.004);
}

TEST(CameraSearch, PortraitAndLandscapePicturesAreOneCamera) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 975, 530, -0.05}};
  const SyntheticScene scene = MakeScene(SceneKind::kSail, truth, 6);
  for (const int quarter_turns : {1, 3}) {
    std::vector<DatabaseImage> images = DatabaseImages(scene);
    for (std::size_t i = 0; i < images.size(); i += 2) {
      images[i].camera_id = 2;
      for (MarkerDetection& marker : images[i].detections.markers) {
        for (Eigen::Vector2d& corner : marker.corners_in_image_px) {
          corner = TurnInImage(truth, quarter_turns, corner);
        }
      }
    }
    const Found found = Find(
        images, {{1, UnknownCamera(1920, 1080)}, {2, UnknownCamera(1080, 1920)}}, scene.layout);
    EXPECT_NEAR(FocalError(found, truth), 0.0, 0.004);
    const auto same = TurnCamera(found.all.at(1), quarter_turns);
    EXPECT_NEAR(same.params[1], found.all.at(2).params[1], 1e-6) << quarter_turns;
  }
}

TEST(CameraSearch, ASmallZoomIsMeasuredByTwoCameras) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 960, 540, 0}};
  for (const double zoom : {1.0, 1.03}) {
    SyntheticScene scene = MakeScene(SceneKind::kSail, truth, 9);
    ZoomFrom(8, zoom, &scene);
    const std::vector<DatabaseImage> images = DatabaseImages(scene);
    const std::map<CameraId, Camera> cameras = {{1, truth}};
    const Registration registration = RegisterFrames(images, cameras, scene.layout, {});
    const Model model = MakeSeedModel(registration, images, cameras);
    FocalStep suspicion;
    suspicion.first_image_after = "frame_000008.jpg";
    suspicion.camera_id = 1;
    const auto step = MeasureFocalStep({}, scene.layout, CornerErrorsOf(images), model, suspicion);
    ASSERT_EQ(step.has_value(), zoom > 1.0);
    if (step) {
      EXPECT_NEAR(step->after_px / step->before_px, zoom, 0.005);
    }
  }
}

// The points hide part of a zoom, so that only two cameras tell how large a certain one is. A
// camera that was held upright for every second picture has zoomed as well.
TEST(CameraSearch, ALargeZoomIsMeasuredInPortraitAndLandscape) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 960, 540, 0}};
  SyntheticScene scene = MakeScene(SceneKind::kSail, truth, 9);
  ZoomFrom(8, 1.1, &scene);
  for (const bool has_portraits : {false, true}) {
    std::vector<DatabaseImage> images = DatabaseImages(scene);
    std::map<CameraId, Camera> cameras = {{1, truth}};
    if (has_portraits) cameras[2] = TurnCamera(truth, 1);
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (!has_portraits || i % 2 != 0) continue;
      images[i].camera_id = 2;
      for (MarkerDetection& marker : images[i].detections.markers) {
        for (Eigen::Vector2d& corner : marker.corners_in_image_px) {
          corner = TurnInImage(truth, 1, corner);
        }
      }
    }
    const Registration registration = RegisterFrames(images, cameras, scene.layout, {});
    const Model model = MakeSeedModel(registration, images, cameras);
    FocalStep found;  // as a model with one camera shows it
    found.first_image_after = images[8].detections.image_name;
    found.camera_id = images[8].camera_id;
    found.before_px = 1500;
    found.after_px = 1540;
    found.sigmas = 20;
    ASSERT_TRUE(found.IsCertain() && !found.SpoilsShape());
    const auto step = ConfirmFocalStep({}, scene.layout, CornerErrorsOf(images), &model, found);
    ASSERT_TRUE(step.has_value());
    EXPECT_NEAR(step->after_px / step->before_px, 1.1, 0.005) << has_portraits;
    EXPECT_TRUE(step->SpoilsShape());
    const auto unmeasured =
        ConfirmFocalStep({}, scene.layout, CornerErrorsOf(images), nullptr, found);
    EXPECT_EQ(unmeasured->after_px, 1540);
  }
}

TEST(CameraSearch, ABoardSeenHeadOnIsRefused) {
  // Moved in front of the camera without tilt: focal length and distance stand in for each other.
  const Camera truth{CameraModel::kPinhole, 1920, 1080, {1500, 1500, 960, 540}};
  SyntheticScene scene = MakeScene(SceneKind::kPlane, truth, 7);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& [marker_id, x] : scene.x_in_world) {
    middle += x[0] / static_cast<double>(scene.x_in_world.size());
  }
  const auto& corners = scene.x_in_world.begin()->second;
  const Eigen::Vector3d right = (corners[2] - corners[1]).normalized();
  const Eigen::Vector3d down = (corners[4] - corners[1]).normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = right;
  rotation.row(1) = down;
  rotation.row(2) = right.cross(down);
  std::mt19937 generator(8);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const Eigen::Vector3d shift(0.05 * normal(generator), 0.05 * normal(generator), 2.5);
    Rigid3 pose{Eigen::Quaterniond(rotation), shift - rotation * middle};
    scene.cam_from_world[i] = pose;
    scene.frames[i].markers.clear();
    for (const auto& [marker_id, x] : scene.x_in_world) {
      MarkerDetection marker;
      marker.marker_id = marker_id;
      for (std::size_t c = 0; c < kNumCorners; ++c) {
        marker.corners_in_image_px[c] =
            *ImageFromCam(truth, pose * x[c + 1]) +
            kSearchNoisePx * Eigen::Vector2d(normal(generator), normal(generator));
      }
      scene.frames[i].markers.push_back(marker);
    }
  }
  EXPECT_THROW(Find(scene), DataError);
}

TEST(CameraSearch, ErrorsNeitherDoubtNorAskForACalibration) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 964, 537, -0.05}};
  SyntheticScene scene = MakeScene(SceneKind::kSail, truth, 5);
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    for (MarkerDetection& marker : scene.frames[i].markers) {
      marker.marker_id += static_cast<int>(100 * i);
    }
  }
  try {
    Find(scene);
    ADD_FAILURE() << "no error";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no two images agree"));
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("calibration")));
  }
}

// The user names the central frame for the registration after the search. One that a bad start
// cannot register is an InputError there, which would end the search.
TEST(CameraSearch, ACentralFrameThatCannotBeRegisteredDoesNotEndTheSearch) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 964, 537, -0.05}};
  SyntheticScene scene = MakeScene(SceneKind::kSail, truth, 5);
  // Nothing in this frame is where it is in the others.
  auto& markers = scene.frames[8].markers;
  for (std::size_t i = 0; i + 1 < markers.size(); i += 2) {
    std::swap(markers[i].corners_in_image_px, markers[i + 1].corners_in_image_px);
  }
  const std::vector<DatabaseImage> images = DatabaseImages(scene);
  RegistrationOptions registration;
  registration.central_frame = "8";
  ASSERT_THROW(RegisterFrames(images, {{1, truth}}, scene.layout, registration), InputError);
  MarkerAdjustmentOptions adjustment;
  adjustment.find_camera = true;
  const auto found = FindCameras(images, {{1, UnknownCamera(1920, 1080)}}, scene.layout,
                                 CornerErrorsOf(images), registration, adjustment);
  EXPECT_NEAR(MeanFocalLength(found.at(1)) / 1500, 1.0, 0.01);
}

}  // namespace
}  // namespace velamap
