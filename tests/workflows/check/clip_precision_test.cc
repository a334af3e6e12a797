#include "workflows/check/clip_precision.h"

#include <gmock/gmock.h>

#include "importer/database/colmap_database.h"
#include "importer/video/frame_source.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

SyntheticScene FilmedSail(int num_frames = 32) {
  SyntheticSceneOptions options;
  options.num_rows = 4;
  options.num_columns = 5;
  options.num_frames = num_frames;
  options.camera = {CameraModel::kSimpleRadial, 1920, 1080, {1500, 960, 540, 0}};
  SyntheticScene scene = MakeSyntheticScene(options);
  SyntheticNoiseOptions noise;
  noise.corner_sigma_px = 0.1;
  AddNoise(noise, &scene);
  return scene;
}

// Filmed with a lens that is zoomed in the middle of the clip.
SyntheticScene ZoomedSail(double zoom, int num_frames = 32) {
  SyntheticScene scene = FilmedSail(num_frames);
  ZoomFrom(scene.frames.size() / 2, zoom, &scene);
  return scene;
}

ClipPrecision PrecisionOf(const SyntheticScene& scene, bool is_calibrated = true) {
  const TempDir dir;
  const std::string path = (dir / "clip.db").string();
  {
    ColmapDatabase database(path, ColmapDatabase::Mode::kReadWriteCreate);
    ColmapDatabase::Transaction transaction(&database);
    const Camera& camera = scene.camera;
    const CameraId camera_id = database.AddCamera(
        is_calibrated ? camera : UnknownCamera(camera.width_px, camera.height_px), is_calibrated);
    for (const FrameDetections& frame : scene.frames) database.AddImage(camera_id, frame, "test");
    transaction.Commit();
  }
  return MeasurePrecision(path, scene.layout, 1);
}

// The points of a model with one camera hide more than half of a zoom.
TEST(ClipPrecision, AZoomIsMeasuredBeforeItIsNamed) {
  const ClipPrecision precision = PrecisionOf(ZoomedSail(1.08));
  ASSERT_TRUE(precision.steadiness.step.has_value());
  EXPECT_NEAR(precision.steadiness.step->after_px / precision.steadiness.step->before_px, 1.08,
              0.005);
  EXPECT_TRUE(precision.steadiness.step->SpoilsShape());
}

// In a short clip, one camera explains the step nearly as well.
TEST(ClipPrecision, AZoomThatIsOnlySuspiciousIsMeasuredToo) {
  const ClipPrecision precision = PrecisionOf(ZoomedSail(1.05, 16));
  ASSERT_TRUE(precision.steadiness.step.has_value());
  EXPECT_NEAR(precision.steadiness.step->after_px / precision.steadiness.step->before_px, 1.05,
              0.005);
}

TEST(ClipPrecision, ASteadyLensHasNoStep) {
  const ClipPrecision precision = PrecisionOf(ZoomedSail(1.0));
  EXPECT_FALSE(precision.steadiness.step.has_value());
  EXPECT_EQ(precision.num_images, 32);
  EXPECT_EQ(precision.num_markers, 20);
}

TEST(ClipPrecision, TheCameraIsFoundWithoutACalibration) {
  const ClipPrecision precision = PrecisionOf(ZoomedSail(1.0), false);
  EXPECT_FALSE(precision.steadiness.step.has_value());
  EXPECT_EQ(precision.num_images, 32);
  ASSERT_EQ(precision.found_cameras.size(), 1u);
  const EstimatedCamera& found = precision.found_cameras.front();
  EXPECT_NEAR(found.camera.params[0], 1500.0, 4 * found.sigmas[0]);
}

TEST(ClipPrecision, AZoomShowsWithoutACalibration) {
  const ClipPrecision precision = PrecisionOf(ZoomedSail(1.08), false);
  ASSERT_TRUE(precision.steadiness.step.has_value());
  EXPECT_NEAR(precision.steadiness.step->after_px / precision.steadiness.step->before_px, 1.08,
              0.01);
}

// Each frame agrees with one camera or the other, and no step in time divides them.
TEST(ClipPrecision, TwoCamerasThatAlternateAreMeasured) {
  SyntheticScene scene = FilmedSail();
  ZoomWhere([](std::size_t i) { return i % 2 == 1; }, 1.1, &scene);
  for (const bool is_calibrated : {true, false}) {
    const ClipPrecision precision = PrecisionOf(scene, is_calibrated);
    ASSERT_TRUE(precision.steadiness.step.has_value()) << is_calibrated;
    EXPECT_FALSE(precision.steadiness.step->IsInTime());
    EXPECT_NEAR(precision.steadiness.step->after_px / precision.steadiness.step->before_px, 1.1,
                0.005);
    EXPECT_TRUE(precision.steadiness.step->SpoilsShape());
  }
}

// Copies of one frame, whose noise is the same, are no evidence against the frames after them.
TEST(ClipPrecision, AZoomBehindRepeatedFramesIsFound) {
  for (const double zoom : {1.0, 1.05}) {
    SyntheticScene scene = ZoomedSail(zoom);
    const FrameDetections first = scene.frames.front();
    scene.frames.insert(scene.frames.begin(), 40, first);
    for (std::size_t i = 0; i < scene.frames.size(); ++i) {
      FrameDetections& frame = scene.frames[i];
      frame.frame_number = static_cast<int>(i);
      frame.time_s = static_cast<double>(i) / 30;
      frame.image_name = NameOfVideoFrame(static_cast<int>(i));
    }
    const ClipPrecision precision = PrecisionOf(scene);
    EXPECT_EQ(precision.num_images, 32);
    ASSERT_EQ(precision.steadiness.step.has_value(), zoom > 1);
    if (zoom == 1) continue;
    EXPECT_NEAR(precision.steadiness.step->after_px / precision.steadiness.step->before_px, zoom,
                0.005);
  }
}

}  // namespace
}  // namespace velamap
