#include "importer/frame_camera.h"

#include <fstream>

#include <gtest/gtest.h>

#include "importer/base/error.h"
#include "importer/camera/turned_camera.h"
#include "tests/importer/photo/exif_builder.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

const Camera kPortrait{
    CameraModel::kOpenCV, 300, 400, {350, 352, 147, 205, -0.1, 0.02, 1e-3, -2e-3}};

class FrameCamera : public testing::Test {
 protected:
  FrameCamera() {
    options_.image_path = dir_.path().string();
    options_.camera_path = "camera.yml";
  }

  // A photograph of this size whose EXIF has these values; 0: not there.
  Frame WritePhoto(int width_px, int height_px, int orientation, int focal_35mm) {
    ExifBuilder exif;
    if (orientation > 0) exif.SetShort(EXIF_IFD_0, EXIF_TAG_ORIENTATION, orientation);
    if (focal_35mm > 0) {
      exif.SetShort(EXIF_IFD_EXIF, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM, focal_35mm);
    }
    std::ofstream(dir_.path() / "a.jpg", std::ios::binary)
        << "\xFF\xD8" << exif.Segment() << "\xFF\xD9";
    Frame frame;
    frame.image_name = "a.jpg";
    frame.gray = cv::Mat(height_px, width_px, CV_8U);
    return frame;
  }

  TempDir dir_;
  MarkerImporterOptions options_;
};

TEST_F(FrameCamera, ACalibrationOfEitherOrientationServesATurnedPhotograph) {
  options_.camera = kPortrait;
  // The file's pixels are those of the sensor, and are turned to be looked at.
  EXPECT_EQ(CameraOfFrame(options_, false, WritePhoto(400, 300, 6, 0)), TurnCamera(kPortrait, -1));
  EXPECT_EQ(CameraOfFrame(options_, false, WritePhoto(400, 300, 8, 0)), TurnCamera(kPortrait, 1));
  // A calibration of the pixels as they are.
  options_.camera = TurnCamera(kPortrait, -1);
  EXPECT_EQ(CameraOfFrame(options_, false, WritePhoto(400, 300, 6, 0)), *options_.camera);
  EXPECT_EQ(CameraOfFrame(options_, false, WritePhoto(400, 300, 1, 0)), *options_.camera);
}

TEST_F(FrameCamera, WithoutATurnInExifTheCalibrationHasToFit) {
  options_.camera = kPortrait;
  for (const int orientation : {0, 1, 3}) {
    const Frame frame = WritePhoto(400, 300, orientation, 0);
    ExpectThrows<InputError>([&] { CameraOfFrame(options_, false, frame); },
                             {"camera.yml", "turned by 90 degrees", "a.jpg"});
  }
}

TEST_F(FrameCamera, AnUnknownCameraBeginsWithWhatExifClaims) {
  const Camera claimed = CameraOfFrame(options_, false, WritePhoto(400, 300, 0, 26));
  EXPECT_NEAR(MeanFocalLength(claimed), 26 / 43.2666 * 500, 1e-3);
  EXPECT_EQ(CameraOfFrame(options_, false, WritePhoto(400, 300, 0, 0)), UnknownCamera(400, 300));
  EXPECT_EQ(CameraOfFrame(options_, true, WritePhoto(400, 300, 0, 26)), UnknownCamera(400, 300));
}

TEST_F(FrameCamera, RecognizesItsCalibrationInEitherOrientation) {
  options_.camera = kPortrait;
  EXPECT_TRUE(IsSameCalibration(options_, kPortrait));
  EXPECT_TRUE(IsSameCalibration(options_, TurnCamera(kPortrait, -1)));
  Camera other = kPortrait;
  other.params[0] += 1;
  EXPECT_FALSE(IsSameCalibration(options_, other));
  EXPECT_FALSE(IsSameCalibration(options_, TurnCamera(other, 1)));
}

}  // namespace
}  // namespace velamap
