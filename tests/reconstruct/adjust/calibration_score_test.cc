#include "reconstruct/adjust/calibration_score.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>

#include "importer/base/statistics.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

// A sail that fills the image, with prints within their tolerance.
SyntheticScene NoisyScene(SceneKind kind, std::uint32_t seed) {
  SyntheticSceneOptions options;
  options.kind = kind;
  options.num_rows = kind == SceneKind::kCube ? 2 : 4;
  options.num_columns = kind == SceneKind::kCube ? 2 : 5;
  options.num_frames = 12;
  options.seed = seed;
  SyntheticScene scene = WithPrintErrors(MakeSyntheticScene(options), 1e-3, 0.003, seed);
  SyntheticNoiseOptions noise;
  noise.corner_sigma_px = 0.05 + 0.02 * (seed % 6);
  noise.seed = seed;
  AddNoise(noise, &scene);
  return scene;
}

// The evidence that an adjustment with a fixed calibration leaves.
CalibrationEvidence Evidence(const SyntheticScene& scene, const Camera& assumed) {
  Model model = MakeSceneModel(scene);
  for (auto& [camera_id, camera] : model.cameras) camera = assumed;
  MarkerAdjustmentOptions options;
  options.refine_calibration = false;
  return AdjustWithMarkers(options, scene.layout, {}, &model).uncertainty.calibration;
}

Camera WithParams(Camera camera, std::vector<double> params) {
  camera.params = std::move(params);
  return camera;
}

// Wrong in this way for the default camera, OPENCV: fx, fy, cx, cy, k1, k2, p1, p2.
Camera WithFocalLength(const Camera& camera, double factor) {
  std::vector<double> params = camera.params;
  params[0] *= factor;
  params[1] *= factor;
  return WithParams(camera, params);
}

Camera WithoutDistortion(const Camera& camera) {
  std::vector<double> params = camera.params;
  std::fill(params.begin() + 4, params.end(), 0.0);
  return WithParams(camera, params);
}

// The camera of the same model, but another specimen with another lens.
Camera OfAnotherCamera(const Camera& camera) {
  std::vector<double> params = WithFocalLength(camera, 0.94).params;
  params[2] += 25;
  params[3] -= 30;
  for (std::size_t i = 4; i < params.size(); ++i) params[i] *= 0.6;
  return WithParams(camera, params);
}

TEST(CalibrationScore, ARightCalibrationIsLeftAloneAndItsChiSquaredIsThatOfChance) {
  constexpr int kNumDraws = 40;
  int num_contradicted = 0;
  std::vector<double> per_degree;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    const auto seed = static_cast<std::uint32_t>(100 + draw);
    const SyntheticScene scene =
        NoisyScene(draw % 4 == 3 ? SceneKind::kCube : SceneKind::kSail, seed);
    const CalibrationEvidence evidence = Evidence(scene, scene.camera);
    ASSERT_GE(evidence.num_changes, 4) << seed;
    num_contradicted += IsContradicted(evidence);
    per_degree.push_back(evidence.chi_squared / evidence.num_changes);
    EXPECT_LT(std::abs(evidence.focal_change), 4.5 * evidence.focal_sigma) << seed;
  }
  EXPECT_LE(num_contradicted, kNumDraws / 20);
  // The mean over about 8 * 40 squared normal variables has a sigma of 0.08.
  EXPECT_NEAR(ComputeStatistics(per_degree).mean, 1.0, 0.3);
}

// A board of 8 markers of about 20 px that fills a small part of the image. Poses and shape absorb
// nearly all of a warp, so errors that are not independent would pass for the rest. The prints are
// as wrong as their sigmas claim, because what hinders the shape from absorbing a warp is partly
// they.
SyntheticScene SmallBoard(std::uint32_t seed) {
  SyntheticSceneOptions options;
  options.kind = seed % 2 == 0 ? SceneKind::kPlane : SceneKind::kSail;
  options.num_rows = 2;
  options.num_columns = 4;
  options.spacing_m = 0.15;
  options.marker_length_m = 0.06;
  options.num_frames = 24;
  options.camera = {CameraModel::kOpenCV, 1280, 720, {350, 350, 642, 357, -0.1, 0.02, 0, 0}};
  options.seed = seed;
  const MarkerAdjustmentOptions adjustment;
  const double side_sigma = std::hypot(adjustment.print_tolerance,
                                       adjustment.print_resolution_m / options.marker_length_m);
  return WithPrintErrors(MakeSyntheticScene(options), side_sigma, adjustment.cloth_flatness, seed);
}

// How often the true calibration is contradicted over draws of scenes with errors, and the mean
// chi-squared for each degree of freedom.
struct Contradictions {
  int num = 0;
  double per_degree = 0.0;
};

Contradictions CountOverDraws(int num_draws,
                              const std::function<void(std::uint32_t, SyntheticScene*)>& disturb) {
  Contradictions contradictions;
  for (int draw = 0; draw < num_draws; ++draw) {
    const auto seed = static_cast<std::uint32_t>(100 + draw);
    SyntheticScene scene = SmallBoard(seed);
    disturb(seed, &scene);
    const CalibrationEvidence evidence = Evidence(scene, scene.camera);
    contradictions.num += SigmasAgainst(evidence) > kMaxCalibrationSigmas;
    contradictions.per_degree += evidence.chi_squared / evidence.num_changes / num_draws;
  }
  return contradictions;
}

// The noise of the places of the corners must not enter the warps.
TEST(CalibrationScore, NoiseOfFewSmallMarkersIsNoEvidence) {
  const auto [num, per_degree] = CountOverDraws(30, [](std::uint32_t seed, SyntheticScene* scene) {
    AddNoise({0.04 + 0.04 * (seed % 4), 0, 0, 200, seed}, scene);
  });
  EXPECT_LE(num, 1);
  EXPECT_NEAR(per_degree, 1.0, 0.25);
}

TEST(CalibrationScore, WrongCalibrationsAreContradictedAndNamed) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const SyntheticScene scene = NoisyScene(SceneKind::kSail, seed);
    const CalibrationEvidence right = Evidence(scene, scene.camera);
    const CalibrationEvidence long_focal = Evidence(scene, WithFocalLength(scene.camera, 1.1)),
                              no_distortion = Evidence(scene, WithoutDistortion(scene.camera)),
                              other = Evidence(scene, OfAnotherCamera(scene.camera));
    for (const CalibrationEvidence* wrong : {&long_focal, &no_distortion, &other}) {
      EXPECT_TRUE(IsContradicted(*wrong)) << seed;
      EXPECT_GT(SigmasAgainst(*wrong), 2 * SigmasAgainst(right)) << seed;
      EXPECT_GT(wrong->shape_change_m, 3 * right.shape_change_m) << seed;
    }
    EXPECT_NEAR(long_focal.focal_change, 1 / 1.1 - 1, 0.02) << seed;
    EXPECT_GT(long_focal.focal_share, long_focal.distortion_share) << seed;
    EXPECT_GT(no_distortion.distortion_share, no_distortion.focal_share) << seed;
    EXPECT_GT(no_distortion.distortion_share, 0.7) << seed;
  }
}

// What the adjustment refines, it has fitted already.
TEST(CalibrationScore, ARefinedFocalLengthLeavesNothingToExplain) {
  const SyntheticScene scene = NoisyScene(SceneKind::kSail, 3);
  Model model = MakeSceneModel(scene);
  for (auto& [camera_id, camera] : model.cameras) camera = WithFocalLength(camera, 1.02);
  MarkerAdjustmentOptions options;
  options.intrinsics_sigma = 0.1;
  options.refine_calibration = false;
  Model fixed_model = model;
  const auto fixed = AdjustWithMarkers(options, scene.layout, {}, &fixed_model);
  options.refine_focal_length = true;
  const auto refined = AdjustWithMarkers(options, scene.layout, {}, &model);
  EXPECT_TRUE(IsContradicted(fixed.uncertainty.calibration));
  EXPECT_FALSE(IsContradicted(refined.uncertainty.calibration));
}

TEST(CalibrationEvidence, SigmasAreThoseOfTheChiSquaredDistribution) {
  CalibrationEvidence evidence;
  EXPECT_EQ(SigmasAgainst(evidence), 0.0);
  evidence.num_changes = 8;
  evidence.chi_squared = 15.507;  // 95 %
  EXPECT_NEAR(SigmasAgainst(evidence), 1.645, 0.03);
  evidence.chi_squared = 26.124;  // 99.9 %
  EXPECT_NEAR(SigmasAgainst(evidence), 3.090, 0.03);
}

}  // namespace
}  // namespace velamap
