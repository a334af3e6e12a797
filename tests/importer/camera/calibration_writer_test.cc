#include "importer/camera/calibration_writer.h"

#include <random>

#include <gmock/gmock.h>

#include "importer/camera/calibration.h"
#include "tests/support/temp_dir.h"

namespace velamap {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

EstimatedCamera Draw(CameraModel model, std::mt19937* generator) {
  std::uniform_real_distribution<double> focal(700, 3000), center(-40, 40), small(-0.05, 0.05);
  EstimatedCamera estimate;
  estimate.camera = {model, 1920, 1080, {}};
  std::vector<double>& params = estimate.camera.params;
  const bool has_one = model == CameraModel::kSimplePinhole ||
                       model == CameraModel::kSimpleRadial || model == CameraModel::kRadial;
  params.push_back(focal(*generator));
  if (!has_one) params.push_back(focal(*generator));
  params.push_back(960 + center(*generator));
  params.push_back(540 + center(*generator));
  while (static_cast<int>(params.size()) < NumCameraParams(model)) {
    params.push_back(small(*generator));
  }
  estimate.sigmas.assign(params.size(), 0.5);
  return estimate;
}

TEST(CalibrationWriter, RoundTripKeepsEveryRay) {
  const TempDir folder;
  const std::string path = (folder.path() / "camera.yml").string();
  std::mt19937 generator(5);
  for (const CameraModel model :
       {CameraModel::kSimplePinhole, CameraModel::kPinhole, CameraModel::kSimpleRadial,
        CameraModel::kRadial, CameraModel::kOpenCV, CameraModel::kOpenCVFisheye,
        CameraModel::kFullOpenCV}) {
    const EstimatedCamera estimate = Draw(model, &generator);
    WriteCalibration(estimate, "a test", path);
    const Camera read = ReadCalibration(path);
    EXPECT_EQ(read.width_px, 1920);
    EXPECT_EQ(read.height_px, 1080);
    for (const double u : {-0.6, -0.1, 0.3}) {
      for (const double v : {-0.3, 0.0, 0.35}) {
        const Eigen::Vector3d x(u, v, 1.0);
        EXPECT_LT((*ImageFromCam(read, x) - *ImageFromCam(estimate.camera, x)).norm(), 1e-9)
            << CameraModelName(model);
      }
    }
  }
}

TEST(CalibrationWriter, NamesSigmasAndOrigin) {
  const EstimatedCamera estimate{
      {CameraModel::kSimpleRadial, 1920, 1080, {901.25, 964.5, 537.0, -0.2451}},
      {0.4, 0.5, 0.6, 0.0012}};
  const std::string text = CalibrationText(estimate, "found by a test");
  EXPECT_THAT(text, HasSubstr("# found by a test"));
  EXPECT_THAT(text, HasSubstr("focal_length_sigma_px"));
  EXPECT_EQ(DescribeCamera(estimate),
            "SIMPLE_RADIAL, focal length 901.2 +- 0.4 px, principal point (964.5 +- 0.5, 537.0 +- "
            "0.6) px, distortion k1 -0.2451 +- 0.0012");
  EXPECT_THAT(DescribeCamera(estimate, "\u00b1"), HasSubstr("length 901.2 \u00b1 0.4 px"));
}

TEST(CalibrationWriter, SaysWhyACameraServesNoOtherClip) {
  EstimatedCamera found{{CameraModel::kSimpleRadial, 1920, 1080, {900, 960, 540, -0.05}},
                        {8.9, 0.5, 0.6, 0.001}};
  EXPECT_EQ(WhyNotForOtherClips(found), "");
  found.sigmas.front() = 15;
  EXPECT_EQ(WhyNotForOtherClips(found), "the focal length is known to 1.7 % only");
  found.camera.params.back() = -0.3;  // no ray is seen as far out as the corners of the image
  EXPECT_THAT(WhyNotForOtherClips(found), HasSubstr("folds over inside the picture"));
}

TEST(CalibrationWriter, ParametersThatWereHeldAtZeroAreNotDescribed) {
  EstimatedCamera estimate{{CameraModel::kFullOpenCV, 1920, 1080, {901, 901, 964, 537}},
                           {0.4, 0.4, 0.5, 0.6}};
  estimate.camera.params.insert(estimate.camera.params.end(), {-0.2, 0.1, 0, 0.001, 0.03, 0, 0, 0});
  estimate.sigmas.insert(estimate.sigmas.end(), {0.01, 0.01, 0.00002, 0.001, 0.01, 0, 0, 0});
  const std::string text = DescribeCamera(estimate);
  EXPECT_THAT(text, HasSubstr("focal length 901.0 +- 0.4 px"));
  EXPECT_THAT(text, HasSubstr("p1 0.00000 +- 0.00002, p2 0.0010 +- 0.0010"));
  EXPECT_THAT(text, EndsWith(", k3 0.0300 +- 0.0100"));
}

}  // namespace
}  // namespace velamap
