#include "reconstruct/adjust/camera_adjustment.h"

#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "reconstruct/register_frames.h"
#include "reconstruct/seed_model.h"
#include "tests/reconstruct/registration_fixture.h"

namespace velamap {
namespace {

TEST(MeasureFocalStep, IsOnePercentOrMoreInSigmasOfBothCameras) {
  const Camera truth{CameraModel::kSimpleRadial, 1920, 1080, {1500, 960, 540, 0}};
  SyntheticSceneOptions options;
  options.num_rows = 4;
  options.num_columns = 5;
  options.num_frames = 16;
  options.camera = truth;
  options.seed = 9;
  SyntheticScene scene = MakeSyntheticScene(options);
  AddNoise({0.1, 0, 0, 200, 9}, &scene);
  for (const double zoom : {1.005, 1.017}) {
    SyntheticScene zoomed = scene;
    ZoomFrom(8, zoom, &zoomed);
    const std::vector<DatabaseImage> images = DatabaseImages(zoomed);
    const std::map<CameraId, Camera> cameras = {{1, truth}};
    Model model = MakeSeedModel(RegisterFrames(images, cameras, scene.layout, {}), images, cameras);
    const CornerErrors errors = CornerErrorsOf(images);
    FocalStep suspicion;
    suspicion.first_image_after = images[8].detections.image_name;
    suspicion.camera_id = 1;
    const auto step = MeasureFocalStep({}, scene.layout, errors, model, suspicion);
    ASSERT_EQ(step.has_value(), zoom > 1.01) << zoom;
    if (!step) continue;
    model.cameras[2] = truth;
    for (ModelImage& image : model.images) {
      if (image.name >= suspicion.first_image_after) image.camera_id = 2;
    }
    const auto sigmas_px = AdjustCameras({}, scene.layout, errors, model).focal_sigmas_px;
    EXPECT_NEAR(step->sigmas,
                (step->after_px - step->before_px) / std::hypot(sigmas_px.at(1), sigmas_px.at(2)),
                1e-6 * step->sigmas);
  }
}

}  // namespace
}  // namespace velamap
