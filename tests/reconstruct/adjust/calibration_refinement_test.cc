// The marker-aware adjustment with a calibration that is right, wrong, or freed by an option.

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double kNoisePx = 0.05;

class CalibrationRefinement : public testing::Test {
 protected:
  explicit CalibrationRefinement(const Camera& camera = {}) {
    SyntheticSceneOptions options;
    options.num_rows = 4;
    options.num_columns = 5;
    options.num_frames = 16;
    options.camera = camera;
    scene_ = MakeSyntheticScene(options);
    truth_ = MakeSceneModel(scene_);
  }

  Model NoisyModel(std::uint32_t seed) const {
    SyntheticScene noisy = scene_;
    AddNoise({kNoisePx, 0, 0, 200, seed}, &noisy);
    Model model = MakeSceneModel(noisy);
    PerturbSeed(0.003, seed, &model);
    return model;
  }

  MarkerAdjustmentSummary Adjust(Model* model, const MarkerAdjustmentOptions& options = {}) const {
    return AdjustWithMarkers(options, scene_.layout, {}, model);
  }

  SyntheticScene scene_;
  Model truth_;
};

MarkerAdjustmentOptions Held() {
  MarkerAdjustmentOptions options;
  options.refine_calibration = false;
  return options;
}

MarkerAdjustmentOptions AllFree() {
  MarkerAdjustmentOptions options;
  options.refine_focal_length = options.refine_principal_point = options.refine_extra_params = true;
  return options;
}

TEST_F(CalibrationRefinement, ARightCalibrationIsNotTouched) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Model model = NoisyModel(seed), held = model;
    Adjust(&model);
    Adjust(&held, Held());
    EXPECT_EQ(model.cameras, truth_.cameras) << seed;
    EXPECT_EQ(Bytes(model), Bytes(held)) << seed;
  }
}

TEST_F(CalibrationRefinement, AWrongFocalLengthIsFoundAndNamed) {
  const double focal_px = MeanFocalLength(truth_.cameras.at(1));
  std::uint32_t seed = 20;
  for (const double factor : {0.9, 0.97, 1.01, 1.03, 1.1}) {
    Model model = NoisyModel(++seed), right = model;
    for (const std::size_t i : {0, 1}) model.cameras.at(1).params[i] *= factor;
    Model held = model;
    const auto summary = Adjust(&model);
    Adjust(&held, Held());
    Adjust(&right);
    const double error_m = MaxPointError(model, truth_);
    EXPECT_NEAR(MeanFocalLength(model.cameras.at(1)) / focal_px, 1.0, 3e-3) << factor;
    EXPECT_LT(error_m, 0.5 * MaxPointError(held, truth_)) << factor;
    EXPECT_LT(error_m, 3.0 * MaxPointError(right, truth_)) << factor;
    if (std::abs(factor - 1.0) > 0.02) {
      EXPECT_THAT(summary.warnings, Contains(HasSubstr("contradict the calibration"))) << factor;
    }
  }
}

TEST_F(CalibrationRefinement, MissingDistortionIsFoundWhetherTheFileHasZerosOrNothing) {
  for (const bool has_zeros : {true, false}) {
    Model model = NoisyModel(40), right = model;
    Camera& camera = model.cameras.at(1);
    ASSERT_EQ(camera.model, CameraModel::kOpenCV);
    if (has_zeros) {
      std::fill(camera.params.begin() + 4, camera.params.end(), 0.0);
    } else {
      camera.model = CameraModel::kPinhole;
      camera.params.resize(4);
    }
    Model held = model;
    const auto summary = Adjust(&model);
    Adjust(&held, Held());
    Adjust(&right);
    EXPECT_THAT(summary.warnings, Contains(HasSubstr("contradict the calibration")));
    EXPECT_LT(MaxPointError(model, truth_), 0.5 * MaxPointError(held, truth_));
    EXPECT_LT(MaxPointError(model, truth_), 3.0 * MaxPointError(right, truth_));
  }
}

TEST_F(CalibrationRefinement, AnOptionThatFreesParametersDecidesInstead) {
  Model model = NoisyModel(50);
  for (const std::size_t i : {0, 1}) model.cameras.at(1).params[i] *= 1.03;
  MarkerAdjustmentOptions options;
  options.refine_principal_point = true;
  const auto summary = Adjust(&model, options);
  EXPECT_EQ(model.cameras.at(1).params[0], 1.03 * truth_.cameras.at(1).params[0]);
  EXPECT_THAT(summary.warnings, Not(Contains(HasSubstr("contradict the calibration"))));
}

// The scene seen by frames between which the cloth moves by some mm, or of which the rows are read
// over 20 ms by a camera that moves, with noise.
SyntheticScene WithMotion(const SyntheticScene& scene, bool is_cloth, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  SyntheticScene moving = scene;
  AddNoise({kNoisePx, 0, 0, 200, seed}, &moving);
  Eigen::Vector3d linear(0, 0, 0), angular(0, 0, 0);
  for (std::size_t i = 0; i < moving.frames.size(); ++i) {
    const double amplitude_m = 5e-3 * normal(random), phase = normal(random);
    for (int axis = 0; axis < 3; ++axis) {
      linear[axis] = 0.7 * linear[axis] + 0.3 * normal(random);
      angular[axis] = 0.7 * angular[axis] + 0.1 * normal(random);
    }
    for (MarkerDetection& marker : moving.frames[i].markers) {
      for (int c = 0; c < kNumCorners; ++c) {
        const Eigen::Vector3d& x = scene.x_in_world.at(marker.marker_id)[c + 1];
        const Eigen::Vector3d still = scene.cam_from_world[i] * x;
        const Eigen::Vector2d still_px = ImageFromCam(scene.camera, still).value();
        const double time_s = 0.02 * (still_px.y() / scene.camera.height_px - 0.5);
        const Eigen::Vector3d wave(0, 0, amplitude_m * std::sin(3.0 * x.x() + phase));
        const Eigen::Vector3d moved =
            is_cloth ? scene.cam_from_world[i] * (x + wave)
                     : Eigen::Vector3d(still + time_s * (linear + angular.cross(still)));
        marker.corners_in_image_px[c] += ImageFromCam(scene.camera, moved).value() - still_px;
      }
    }
  }
  return moving;
}

// What the adjustment does not know must not pass for the calibration.
TEST_F(CalibrationRefinement, MotionIsNotTakenForTheCalibration) {
  for (const bool is_cloth : {true, false}) {
    double sum = 0.0, sum_held = 0.0;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      Model model = MakeSceneModel(WithMotion(scene_, is_cloth, seed)), held = model;
      Adjust(&model);
      Adjust(&held, Held());
      sum += MaxPointError(model, truth_);
      sum_held += MaxPointError(held, truth_);
    }
    EXPECT_LT(sum, 1.1 * sum_held) << (is_cloth ? "cloth" : "rolling shutter");
  }
}

class FiveCoefficients : public CalibrationRefinement {
 protected:
  FiveCoefficients()
      : CalibrationRefinement({CameraModel::kFullOpenCV,
                               1920,
                               1080,
                               {1400, 1400, 962, 538, 0.05, -0.2, 1e-3, -1e-3, 0.2, 0, 0, 0}}) {}
};

TEST_F(FiveCoefficients, FreedParametersStayNearTheCalibration) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Model model = NoisyModel(seed);
    Adjust(&model, AllFree());
    const Camera& camera = model.cameras.at(1);
    for (const std::size_t i : {9, 10, 11}) EXPECT_EQ(camera.params[i], 0.0);
    EXPECT_TRUE(HasMonotonicDistortion(camera));
    const IntrinsicsPrior prior =
        MakeIntrinsicsPrior(truth_.cameras.at(1), {true, true, true}, AllFree().intrinsics_sigma);
    for (const int i : prior.free) {
      const auto idx = static_cast<std::size_t>(i);
      EXPECT_LT(std::abs(camera.params[idx] - prior.mean[idx]), 4.0 * prior.sigmas[idx]) << i;
    }
    EXPECT_LT(MaxPointError(model, truth_), 2e-3) << seed;
  }
}

TEST_F(FiveCoefficients, AWrongFocalLengthIsFoundWithoutUnnamedParameters) {
  Model model = NoisyModel(60);
  for (const std::size_t i : {0, 1}) model.cameras.at(1).params[i] *= 1.05;
  Adjust(&model);
  const Camera& camera = model.cameras.at(1);
  EXPECT_NEAR(MeanFocalLength(camera) / 1400.0, 1.0, 5e-3);
  for (const std::size_t i : {9, 10, 11}) EXPECT_EQ(camera.params[i], 0.0);
}

// The lens of these pictures folds over outside of the markers; the calibration does not.
class FoldedLens : public CalibrationRefinement {
 protected:
  FoldedLens()
      : CalibrationRefinement(
            {CameraModel::kOpenCV, 1920, 1080, {1400, 1400, 960, 540, -0.27, 0, 0, 0}}) {}

  Model ModelWithMonotonicCalibration() const {
    Model model = NoisyModel(70);
    model.cameras.at(1).params[4] = -0.2;
    return model;
  }
};

TEST_F(FoldedLens, ARefinementThatWasAskedForAndFoldsOverIsAnInputError) {
  Model model = ModelWithMonotonicCalibration();
  ASSERT_TRUE(HasMonotonicDistortion(model.cameras.at(1)));
  ASSERT_FALSE(HasMonotonicDistortion(truth_.cameras.at(1)));
  const std::string before = Bytes(model);
  MarkerAdjustmentOptions options;
  options.refine_extra_params = true;
  options.intrinsics_sigma = 0.1;
  ExpectThrows<InputError>(
      [&] { Adjust(&model, options); },
      {"--BundleAdjustment.refine_extra_params 1", "fold over", "leave the option out"});
  EXPECT_EQ(Bytes(model), before);
}

TEST_F(FoldedLens, OneThatTheAdjustmentTriesByItselfIsNotTaken) {
  Model model = ModelWithMonotonicCalibration();
  MarkerAdjustmentOptions options;
  options.intrinsics_sigma = 0.1;
  Adjust(&model, options);
  EXPECT_TRUE(HasMonotonicDistortion(model.cameras.at(1)));
}

}  // namespace
}  // namespace velamap
