#include "reconstruct/geometry/intrinsics_prior.h"

#include <cmath>

#include <gmock/gmock.h>
#include <Eigen/Geometry>

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr FreeIntrinsics kAll{true, true, true};

Camera FiveCoefficients() {
  return {CameraModel::kFullOpenCV,
          1920,
          1080,
          {1400, 1410, 960, 540, 0.05, -0.2, 1e-3, -1e-3, 0.2, 0, 0, 0}};
}

TEST(IntrinsicsPrior, ParametersThatTheCalibrationDoesNotNameAreHeld) {
  EXPECT_THAT(MakeIntrinsicsPrior(FiveCoefficients(), kAll, 0.01).held, ElementsAre(9, 10, 11));
  EXPECT_TRUE(HasUnspecifiedDistortion(FiveCoefficients()));
  Camera rational = FiveCoefficients();
  for (const std::size_t i : {9, 10, 11}) rational.params[i] = 0.1;
  EXPECT_THAT(MakeIntrinsicsPrior(rational, kAll, 0.01).held, IsEmpty());
  EXPECT_FALSE(HasUnspecifiedDistortion(rational));
  const Camera without{CameraModel::kOpenCV, 1920, 1080, {1400, 1410, 960, 540, 0, 0, 0, 0}};
  EXPECT_THAT(MakeIntrinsicsPrior(without, kAll, 0.01).held, IsEmpty());
  EXPECT_FALSE(HasUnspecifiedDistortion(without));
  EXPECT_THAT(MakeIntrinsicsPrior(FiveCoefficients(), {false, true, false}, 0.01).free,
              ElementsAre(2, 3));
}

// Whatever the lens: a wide one and a long one are held equally in the image.
TEST(IntrinsicsPrior, OneSigmaMovesTheFarthestCornerByThatFraction) {
  constexpr double kSigma = 0.01;
  for (const double focal_px : {800.0, 1400.0, 5000.0}) {
    for (const CameraModel model : {CameraModel::kOpenCV, CameraModel::kFullOpenCV,
                                    CameraModel::kRadial, CameraModel::kOpenCVFisheye}) {
      Camera camera{model, 1920, 1080, {focal_px, focal_px, 960, 540}};
      if (model == CameraModel::kRadial) camera.params.erase(camera.params.begin());
      camera.params.resize(static_cast<std::size_t>(NumCameraParams(model)), 0.0);
      const Eigen::Vector2d ray = CamFromImage(camera, {0, 0}).value();
      EXPECT_NEAR(MaxRayLength(camera), ray.norm(), 1e-9);
      const double before_px =
          (ImageFromCam(camera, ray.homogeneous()).value() - Eigen::Vector2d(960, 540)).norm();
      const IntrinsicsPrior prior = MakeIntrinsicsPrior(camera, kAll, kSigma);
      const std::size_t begin = model == CameraModel::kRadial ? 3 : 4;
      for (std::size_t i = begin; i < camera.params.size(); ++i) {
        const bool is_tangential = model != CameraModel::kOpenCVFisheye && (i == 6 || i == 7);
        if (is_tangential) continue;
        Camera moved = camera;
        moved.params[i] += prior.sigmas[i];
        const double after_px =
            (ImageFromCam(moved, ray.homogeneous()).value() - Eigen::Vector2d(960, 540)).norm();
        EXPECT_NEAR(std::abs(after_px / before_px - 1.0), kSigma, 0.02 * kSigma)
            << CameraModelName(model) << " parameter " << i;
      }
    }
  }
}

TEST(IntrinsicsPrior, WhatIsNotClearlyBetterKnownThanThePriorIsNotDetermined) {
  const Camera camera{CameraModel::kOpenCV, 1920, 1080, {1400, 1410, 960, 540, -0.1, 0, 0, 0}};
  const IntrinsicsPrior prior = MakeIntrinsicsPrior(camera, kAll, 0.01);
  Eigen::VectorXd sigmas = Eigen::Map<const Eigen::VectorXd>(prior.sigmas.data(), 8);
  Camera refined = camera;
  const auto determined = [&](const Eigen::VectorXd& factors) {
    return DeterminedIntrinsics(
        kAll, prior, refined,
        sigmas.cwiseProduct(factors).cwiseAbs2().asDiagonal().toDenseMatrix());
  };
  Eigen::VectorXd factors = Eigen::VectorXd::Constant(8, 0.2);
  EXPECT_EQ(determined(factors), kAll);
  factors[1] = 0.5;
  EXPECT_EQ(determined(factors), (FreeIntrinsics{false, true, true}));
  factors[3] = factors[4] = 0.5;
  EXPECT_EQ(determined(factors), FreeIntrinsics{});
  for (const std::size_t i : {0, 1}) refined.params[i] *= 1.05;  // ten sigmas of the estimate
  refined.params[4] = 0.3;
  EXPECT_EQ(determined(factors), (FreeIntrinsics{true, false, true}));
  refined.params[1] *= 1.01;  // no lens does that
  EXPECT_EQ(determined(factors), FreeIntrinsics{});
}

TEST(IntrinsicsPrior, DistortionParamsOfACameraWithoutThemChangeNoImage) {
  for (const Camera& camera :
       {Camera{CameraModel::kPinhole, 1920, 1080, {1400, 1410, 960, 540}},
        Camera{CameraModel::kSimplePinhole, 1920, 1080, {1400, 960, 540}}, FiveCoefficients()}) {
    const Camera with = WithDistortionParams(camera);
    EXPECT_EQ(static_cast<int>(with.params.size()), NumCameraParams(with.model));
    EXPECT_EQ(ImageFromCam(with, {0.3, 0.2, 1.0}), ImageFromCam(camera, {0.3, 0.2, 1.0}));
  }
  EXPECT_EQ(WithDistortionParams(FiveCoefficients()), FiveCoefficients());
}

TEST(IntrinsicsPrior, ARefinementIsDescribedByWhatHasChanged) {
  const Camera camera{CameraModel::kRadial, 1920, 1080, {1400, 960, 540, 0.05, -0.2}};
  Camera refined = camera;
  refined.params[0] = 1388.06;
  EXPECT_EQ(DescribeRefinement(camera, refined), "focal length 1400.0 -> 1388.1 px");
  refined.params[4] = -0.1;
  EXPECT_EQ(DescribeRefinement(camera, refined),
            "focal length 1400.0 -> 1388.1 px, distortion 0.05 -0.2 -> 0.05 -0.1");
  refined = camera;
  refined.params[1] = 961;
  EXPECT_EQ(DescribeRefinement(camera, refined),
            "principal point (960.0, 540.0) -> (961.0, 540.0) px");
}

TEST(IntrinsicsPrior, WithinIsJudgedByTheImageAndNotByTheSizeOfCoefficients) {
  Camera camera{CameraModel::kOpenCV, 1920, 1080, {5000, 5000, 960, 540, -0.09, 0, 0, 0}};
  const IntrinsicsPrior prior = MakeIntrinsicsPrior(camera, kAll, 0.01);
  EXPECT_TRUE(IsWithin(prior, camera));
  Camera moved = camera;
  moved.params[5] = 0.5;  // nothing in the small field of a long lens
  EXPECT_TRUE(IsWithin(prior, moved));
  moved.params[4] = 0.3;
  EXPECT_FALSE(IsWithin(prior, moved));
  moved = camera;
  moved.params[0] *= 1.02;
  EXPECT_FALSE(IsWithin(prior, moved));
}

TEST(IntrinsicsPrior, OfAnUnknownCameraKnowsTheMiddleOfThePicture) {
  const Camera camera{CameraModel::kOpenCV, 1920, 1080, {1400, 1410, 900, 500, 0.1, 0, 0, 0}};
  const IntrinsicsPrior prior = UnknownCameraPrior(camera);
  EXPECT_THAT(prior.held, testing::IsEmpty());
  for (const std::size_t focal : {0, 1}) EXPECT_NEAR(prior.sigmas[focal], 1405, 1e-9);
  for (const std::size_t center : {2, 3}) EXPECT_NEAR(prior.sigmas[center], 0.02 * 1920, 1e-9);
  EXPECT_THAT(std::vector<double>(prior.mean.begin() + 2, prior.mean.end()),
              testing::ElementsAre(960, 540, 0, 0, 0, 0));
}

}  // namespace
}  // namespace velamap
