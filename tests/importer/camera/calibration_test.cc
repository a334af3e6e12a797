#include "importer/camera/calibration.h"

#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "importer/base/error.h"
#include "tests/support/error_matchers.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

std::string WriteText(const TempDir& dir, const std::string& name, const std::string& text) {
  const std::string path = dir / name;
  std::ofstream(path) << text;
  return path;
}

// A calibration as OpenCV itself writes it.
std::string WriteStorage(const TempDir& dir, const std::string& name,
                         const std::vector<double>& distortion, const std::string& model = "") {
  const std::string path = dir / name;
  cv::FileStorage storage(path, cv::FileStorage::WRITE);
  storage << "image_width" << 1920 << "image_height" << 1080;
  storage << "camera_matrix" << cv::Mat(cv::Matx33d(1400, 0, 959.5, 0, 1410, 539.25, 0, 0, 1));
  storage << "distortion_coefficients" << cv::Mat(distortion, true).t();
  if (!model.empty()) storage << "distortion_model" << model;
  return path;
}

TEST(ReadCalibration, ChoosesTheModelThatHoldsTheDistortion) {
  const TempDir dir;
  const std::vector<double> pinhole = {1400, 1410, 960, 539.75};
  const auto with = [&](std::vector<double> more) {
    more.insert(more.begin(), pinhole.begin(), pinhole.end());
    return more;
  };
  const auto expect = [&](const std::vector<double>& distortion, const std::string& model_key,
                          CameraModel model, const std::vector<double>& params) {
    for (const char* name : {"c.yml", "c.xml", "c.json"}) {
      const Camera camera = ReadCalibration(WriteStorage(dir, name, distortion, model_key));
      EXPECT_EQ(camera.model, model) << CameraModelName(camera.model);
      EXPECT_EQ(camera.params, params);
      EXPECT_EQ(camera.width_px, 1920);
      EXPECT_EQ(camera.height_px, 1080);
    }
  };
  expect({0, 0, 0, 0, 0}, "", CameraModel::kPinhole, pinhole);
  expect({-.1, .2, .003, .004}, "", CameraModel::kOpenCV, with({-.1, .2, .003, .004}));
  expect({-.1, .2, .003, .004, 0}, "", CameraModel::kOpenCV, with({-.1, .2, .003, .004}));
  expect({-.1, .2, .003, .004, .5}, "", CameraModel::kFullOpenCV,
         with({-.1, .2, .003, .004, .5, 0, 0, 0}));
  expect({-.1, .2, .003, .004, .5, .6, .7, .8}, "", CameraModel::kFullOpenCV,
         with({-.1, .2, .003, .004, .5, .6, .7, .8}));
  expect({.1, .2, .3, .4}, "fisheye", CameraModel::kOpenCVFisheye, with({.1, .2, .3, .4}));
}

TEST(ReadCalibration, WithoutDistortionValues) {
  const TempDir dir;
  const std::string path =
      WriteText(dir, "c.json",
                "{\"image_width\": 640, \"image_height\": 480, \"distortion_coefficients\": [],"
                " \"camera_matrix\": [500, 0, 319.5, 0, 500, 239.5, 0, 0, 1]}");
  const Camera camera = ReadCalibration(path);
  EXPECT_EQ(camera.model, CameraModel::kPinhole);
  EXPECT_EQ(camera.params, (std::vector<double>{500, 500, 320, 240}));
}

TEST(ReadCalibration, TakesColmapCamerasAsTheyAre) {
  const TempDir dir;
  const Camera camera = ReadCalibration(WriteText(
      dir, "cameras.txt",
      "# Camera list\n# Number of cameras: 1\n1 RADIAL 640 480 500.5 320 240 -0.1 0.02\n"));
  EXPECT_EQ(camera.model, CameraModel::kRadial);
  EXPECT_EQ(camera.params, (std::vector<double>{500.5, 320, 240, -0.1, 0.02}));
}

TEST(ReadCalibration, NamesFileAndKeyOfAnError) {
  const TempDir dir;
  const auto expect = [&](const std::string& text, const std::string& part) {
    const std::string path = WriteText(dir, "bad.yml", text);
    ExpectThrows<InputError>([&] { ReadCalibration(path); }, {path, part});
  };
  const std::string size = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n";
  const std::string matrix = "camera_matrix: [500., 0., 320., 0., 500., 240., 0., 0., 1.]\n";
  expect("", "empty");
  expect("%YAML:1.0\n---\nimage_height: 480\n", "'image_width' is missing");
  expect("%YAML:1.0\n---\nimage_width: -3\nimage_height: 480\n", "'image_width'");
  expect(size, "'camera_matrix' is missing");
  expect(size + "camera_matrix: [1., 2.]\n", "expected 3x3 values, found 2");
  expect(size + "camera_matrix: [0., 0., 320., 0., 500., 240., 0., 0., 1.]\n", "focal lengths");
  expect(size + "camera_matrix: [500., 3., 320., 0., 500., 240., 0., 0., 1.]\n", "no skew");
  expect(size + "camera_matrix: [.Nan, 0., 320., 0., 500., 240., 0., 0., 1.]\n", "not finite");
  expect(size + matrix, "'distortion_coefficients' is missing");
  expect(size + matrix + "distortion_coefficients: [1., 2., 3.]\n", "4, 5 or 8");
  expect(
      size + matrix + "distortion_coefficients: [0., 0., 0., 0., 0., 0., 0., 0., 1., 0., 0., 0.]\n",
      "thin prism");
  expect(size + matrix + "distortion_coefficients: [0., 0., 0., 0.]\ndistortion_model: spline\n",
         "'spline' is unknown");
  expect(size + matrix + "distortion_coefficients: [0., 0.]\ndistortion_model: fisheye\n",
         "4 values");
  expect("%YAML:1.0\n---\nimage_width: [1, 2\n", "not a readable OpenCV FileStorage");
  ExpectThrows<InputError>([&] { ReadCalibration(dir / "none.yml"); },
                           {"none.yml", "there is no such"});
}

TEST(ReadCalibration, RefusesFocalLengthsThatNoCameraHas) {
  const TempDir dir;
  const auto read = [&](double focal_px) {
    return ReadCalibration(WriteText(
        dir, "cameras.txt", fmt::format("1 SIMPLE_PINHOLE 1920 1080 {} 960 540\n", focal_px)));
  };
  for (const double focal_px : {8.75, 191.0, 96001.0}) {
    ExpectThrows<InputError>([&] { read(focal_px); },
                             {"cameras.txt", "focal length", "192 to 96000 px", "not in mm"});
  }
  for (const double focal_px : {192.0, 96000.0}) EXPECT_EQ(read(focal_px).params[0], focal_px);
}

TEST(ReadCalibration, CountsTheNumbersOfAMatrixWithDecimalCommas) {
  const TempDir dir;
  const auto expect = [&](const std::string& matrix, const std::string& part) {
    const std::string path =
        WriteText(dir, "bad.yml", "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n" + matrix);
    ExpectThrows<InputError>([&] { ReadCalibration(path); }, {path, part, "decimal points"});
  };
  const std::string data = "[500,5, 0., 320,5, 0., 500,5, 240,5, 0., 0., 1.]\n";
  expect("camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: " + data,
         "9 are expected, 13 found");
  expect("camera_matrix: " + data, "expected 3x3 values, found 13");
}

TEST(ReadCalibration, NamesTheLineOfCamerasTxt) {
  const TempDir dir;
  const auto expect = [&](const std::string& text, int line, const std::string& part) {
    const std::string path = WriteText(dir, "cameras.txt", text);
    ExpectThrows<InputError>([&] { ReadCalibration(path); },
                             {line > 0 ? path + ":" + std::to_string(line) : path, part});
  };
  expect("# nothing\n", 0, "no camera");
  expect("image_width: 640\n", 1, "CAMERA_ID MODEL WIDTH HEIGHT");
  expect("# c\n1 FOV 640 480 1 2 3\n", 2, "'FOV' is not supported");
  expect("1 PINHOLE 640 480 500 500 320\n", 1, "expected 4 parameters");
  expect("1 PINHOLE 640 480 500 500 320 240 7\n", 1, "expected 4 parameters");
  expect("1 PINHOLE 640 480 500 x 320 240\n", 1, "expected 4 parameters");
  expect("1 PINHOLE 0 480 500 500 320 240\n", 1, "image size");
  expect("1 PINHOLE 640 480 500 500 320 240\n2 PINHOLE 640 480 500 500 320 240\n", 2, "second");
}

TEST(ScaleToImageSize, ScalesFocalLengthAndPrincipalPoint) {
  const Camera camera{CameraModel::kOpenCV, 1920, 1080, {1400, 1410, 960, 540, .1, .2, .3, .4}};
  const Camera half = ScaleToImageSize(camera, 960, 540, "c.yml");
  EXPECT_EQ(half.params, (std::vector<double>{700, 705, 480, 270, .1, .2, .3, .4}));
  EXPECT_EQ(ScaleToImageSize(camera, 1920, 1080, "c.yml"), camera);
  // A point keeps its place relative to the image.
  const Eigen::Vector3d x_in_cam(0.2, -0.1, 1.5);
  EXPECT_LT((0.5 * *ImageFromCam(camera, x_in_cam) - *ImageFromCam(half, x_in_cam)).norm(), 1e-12);
}

TEST(ScaleToImageSize, AcceptsRoundedAndRefusesOtherSizes) {
  const Camera camera{CameraModel::kSimplePinhole, 1920, 1080, {1400, 960, 540}};
  EXPECT_NO_THROW(ScaleToImageSize(camera, 854, 480, "c.yml"));  // 853.33 rounded
  ExpectThrows<InputError>([&] { ScaleToImageSize(camera, 640, 480, "c.yml"); },
                           {"c.yml", "1920x1080", "640x480", "the aspect ratio differs"});
  ExpectThrows<InputError>([&] { ScaleToImageSize(camera, 1080, 1920, "c.yml"); },
                           {"c.yml", "turned by 90 degrees"});
  ExpectThrows<InputError>([&] { ScaleToImageSize(camera, 300, 1080, "c.yml"); },
                           {"c.yml", "1920x1080", "300x1080", "the aspect ratio differs"});
}

TEST(ScaleToImageSize, RoundedSizesScaleOneFocalLengthByTheMeanOfBothAxes) {
  const Camera camera{CameraModel::kSimplePinhole, 1920, 1080, {1400, 960, 540}};
  const Camera scaled = ScaleToImageSize(camera, 854, 480, "c.yml");
  EXPECT_NEAR(scaled.params[0], 1400 * (854.0 / 1920 + 480.0 / 1080) / 2, 1e-9);
  EXPECT_NEAR(scaled.params[1], 427, 1e-9);
  EXPECT_NEAR(scaled.params[2], 240, 1e-9);
}

TEST(ScaleToImageSize, RefusesSizesThatNoRoundingExplains) {
  const Camera camera{CameraModel::kSimplePinhole, 1920, 1080, {1400, 960, 540}};
  for (const int width_px : {851, 856}) {
    ExpectThrows<InputError>([&] { ScaleToImageSize(camera, width_px, 480, "c.yml"); },
                             {"c.yml", "the aspect ratio differs"});
  }
}

}  // namespace
}  // namespace velamap
