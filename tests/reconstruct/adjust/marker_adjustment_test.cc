#include "reconstruct/adjust/marker_adjustment.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "importer/base/error.h"
#include "reconstruct/model/gauge.h"
#include "reconstruct/model/reprojection.h"
#include "tests/reconstruct/scene_model.h"
#include "tests/reconstruct/sheet_model.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

SyntheticScene SmallScene() {
  SyntheticSceneOptions options;
  options.num_rows = 3;
  options.num_columns = 4;
  options.num_frames = 9;
  return MakeSyntheticScene(options);
}

// Largest distance between points of the same id, both models in the frame of `model`'s first
// image, m: no alignment, no scale.
double MaxErrorInFirstCamera(const Model& model, const Model& truth) {
  const Rigid3 first_from_truth = truth.FindImage(model.images.front().image_id)->cam_from_world;
  double max_error = 0.0;
  for (const auto& [point3D_id, point] : model.points3D) {
    const Eigen::Vector3d expected = first_from_truth * truth.points3D.at(point3D_id).x_in_world;
    max_error = std::max(max_error, (point.x_in_world - expected).norm());
  }
  return max_error;
}

class MarkerAdjustment : public testing::Test {
 protected:
  MarkerAdjustmentSummary Adjust(Model* model, const MarkerAdjustmentOptions& options = {},
                                 const CornerErrors& errors = {}) const {
    return AdjustWithMarkers(options, scene_.layout, errors, model);
  }

  Model NoisyModel(double corner_sigma_px, std::uint32_t seed) const {
    SyntheticScene noisy = scene_;
    AddNoise({corner_sigma_px, 0, 0, 200, seed}, &noisy);
    Model model = MakeSceneModel(noisy);
    PerturbSeed(0.003, seed, &model);
    return model;
  }

  SyntheticScene scene_ = SmallScene();
  const Model truth_ = MakeSceneModel(scene_);
};

TEST_F(MarkerAdjustment, NoiseFreeTruthComesBackInMetres) {
  Model model = truth_;
  PerturbSeed(0.01, 1, &model);
  TransformModel({0.03, Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized(), {5, -8, 13}}, &model);
  const auto summary = Adjust(&model);
  CheckModel(model);
  EXPECT_GT(summary.error_before_px.mean, 10);
  EXPECT_LT(summary.error_after_px.max, 1e-9);
  EXPECT_LT(MaxErrorInFirstCamera(model, truth_), 1e-9);
  EXPECT_THAT(summary.removed, IsEmpty());
  EXPECT_THAT(summary.removed_images, IsEmpty());
  EXPECT_THAT(summary.warnings, IsEmpty());
  EXPECT_EQ(model.cameras, truth_.cameras);
  EXPECT_EQ(model.images.front().cam_from_world.translation, Eigen::Vector3d::Zero());
}

TEST_F(MarkerAdjustment, NoiseIsFoundOutAndPointErrorsAreTrue) {
  Model model = NoisyModel(0.3, 2);
  const auto summary = Adjust(&model);
  // 0.3 px against the options' 0.1 and 0.02.
  EXPECT_NEAR(std::sqrt(summary.uncertainty.variance_factor), 0.3 / std::hypot(0.1, 0.02), 0.15);
  EXPECT_LT(summary.num_iterations, 60);
  EXPECT_LT(MaxErrorInFirstCamera(model, truth_), 0.01);
  Model updated = model;
  UpdatePointErrors(&updated);
  EXPECT_EQ(Bytes(updated), Bytes(model));
}

TEST_F(MarkerAdjustment, SameInputSameBytesWhateverTheThreads) {
  const Model seed = NoisyModel(0.2, 3);
  MarkerAdjustmentOptions options;
  options.num_threads = 1;
  Model expected = seed;
  const auto expected_summary = Adjust(&expected, options);
  for (const int num_threads : {1, 2, 5}) {
    options.num_threads = num_threads;
    Model model = seed;
    const auto summary = Adjust(&model, options);
    EXPECT_EQ(Bytes(model), Bytes(expected)) << num_threads;
    EXPECT_EQ(summary.uncertainty.points.factor, expected_summary.uncertainty.points.factor);
    EXPECT_EQ(summary.uncertainty.correlation_factor,
              expected_summary.uncertainty.correlation_factor);
  }
}

TEST_F(MarkerAdjustment, SimilarityOfTheInputChangesNothing) {
  Model model = NoisyModel(0.2, 3), moved = model;
  TransformModel({17, Eigen::Quaterniond(0.1, 0.5, -0.7, 0.4).normalized(), {5, -8, 13}}, &moved);
  Adjust(&model);
  Adjust(&moved);
  EXPECT_LT(MaxErrorInFirstCamera(moved, model), 1e-7);
}

TEST_F(MarkerAdjustment, OrderOfTheImagesChangesTheFrameOnly) {
  Model model = NoisyModel(0.2, 3), reversed = model;
  std::reverse(reversed.images.begin(), reversed.images.end());
  const auto summary = Adjust(&model), summary_reversed = Adjust(&reversed);
  EXPECT_EQ(reversed.images.front().image_id, 9u);
  EXPECT_LT(MaxErrorInFirstCamera(reversed, model), 1e-6);
  EXPECT_NEAR(summary.uncertainty.relative_scale_sigma,
              summary_reversed.uncertainty.relative_scale_sigma,
              1e-3 * summary.uncertainty.relative_scale_sigma);
}

TEST_F(MarkerAdjustment, GrossOutliersAreRemovedAndNothingElse) {
  SyntheticScene noisy = scene_;
  AddNoise({0.1, 0, 0, 200, 4}, &noisy);
  Model model = MakeSceneModel(noisy), clean = model;
  const auto outliers = AddOutliers(0.02, 3, &model);
  ASSERT_GT(outliers.size(), 4u);
  const auto summary = Adjust(&model);
  Adjust(&clean);
  EXPECT_GE(summary.removed.size(), outliers.size());
  EXPECT_LE(summary.removed.size(), outliers.size() + 2);
  for (const auto& [point3D_id, element] : outliers) {
    EXPECT_EQ(model.FindImage(element.image_id)->points2D[element.point2D_idx].point3D_id,
              kInvalidPoint3DId);
  }
  EXPECT_LT(MaxErrorInFirstCamera(model, clean), 2e-3);
  EXPECT_LT(summary.uncertainty.share_above_4_sigma, 0.005);
  CheckModel(model);
}

TEST_F(MarkerAdjustment, WorseCornersCountLess) {
  // Half of the images are ten times as noisy; who knows which gets a better shape.
  SyntheticScene noisy = scene_;
  AddNoise({0.05, 0, 0, 200, 5}, &noisy);
  SyntheticScene noisier = scene_;
  AddNoise({1.0, 0, 0, 200, 6}, &noisier);
  CornerErrors errors;
  for (std::size_t i = 0; i < noisy.frames.size(); ++i) {
    if (i % 2 == 1) noisy.frames[i] = noisier.frames[i];
    errors.sigmas_px[static_cast<ImageId>(i + 1)].assign(4 * noisy.frames[i].markers.size(),
                                                         i % 2 == 1 ? 1.0 : 0.05);
  }
  Model informed = MakeSceneModel(noisy), uninformed = informed;
  MarkerAdjustmentOptions options;
  options.outlier_sigmas = options.loss_sigmas = 100;  // so that nothing but the weights decides
  const auto summary = Adjust(&informed, options, errors);
  Adjust(&uninformed, options);
  EXPECT_NEAR(summary.uncertainty.variance_factor, 1.0, 0.25);
  EXPECT_LT(2 * MaxPointError(informed, truth_), MaxPointError(uninformed, truth_));
}

TEST_F(MarkerAdjustment, InsetIsEstimatedWhereDistancesDiffer) {
  SyntheticSceneOptions options;
  options.kind = SceneKind::kCube;
  options.num_rows = options.num_columns = 2;
  options.num_frames = 24;
  scene_ = MakeSyntheticScene(options);
  const Model truth = MakeSceneModel(scene_);
  // A camera that comes closer: sizes in the image from 1 to 3.
  for (std::size_t i = 0; i < scene_.cam_from_world.size(); i += 2) {
    Rigid3& pose = scene_.cam_from_world[i];
    pose.translation *= 2.5;
  }
  ProjectAnew(&scene_);
  constexpr double kInsetPx = 0.05;
  AddInset([](const MarkerDetection&) { return kInsetPx; }, &scene_);
  Model model = MakeSceneModel(scene_), without = model;
  MarkerAdjustmentOptions adjustment;
  adjustment.inset_sigma_px = 0.1;
  adjustment.estimate_inset = true;
  const auto summary = Adjust(&model, adjustment);
  EXPECT_NEAR(summary.uncertainty.apparent_inset_px, kInsetPx, 1e-4);
  EXPECT_LT(MaxErrorInFirstCamera(model, MakeSceneModel(scene_)), 1e-5);
  adjustment.inset_sigma_px = 0;
  const auto summary_without = Adjust(&without, adjustment);
  EXPECT_EQ(summary_without.uncertainty.apparent_inset_sigma_px, 0.0);
  EXPECT_GT(MaxErrorInFirstCamera(without, MakeSceneModel(scene_)), 1e-3);
}

TEST_F(MarkerAdjustment, AMarkerOfTheWrongSizeIsReportedAndBendsNothing) {
  SyntheticScene noisy = scene_;
  ResizeMarker(6, 1.03, &noisy);
  const Model truth = MakeSceneModel(noisy);
  AddNoise({0.05, 0, 0, 200, 7}, &noisy);
  Model model = MakeSceneModel(noisy);
  const auto summary = Adjust(&model);
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_THAT(summary.warnings[0], HasSubstr("marker 6 is"));
  EXPECT_THAT(summary.warnings[0], HasSubstr("larger"));
  // Its true size comes out of the images.
  const double side_m =
      (model.points3D.at(61).x_in_world - model.points3D.at(62).x_in_world).norm();
  EXPECT_NEAR(side_m, 0.103, 0.0005);
  EXPECT_LT(MaxErrorInFirstCamera(model, truth), 4e-3);
}

TEST_F(MarkerAdjustment, MarkersThatScatterMoreThanTheirToleranceAreReported) {
  SyntheticScene noisy = WithPrintErrors(scene_, 0.02, 0.0, 8);
  AddNoise({0.02, 0, 0, 200, 7}, &noisy);
  Model model = MakeSceneModel(noisy);
  const auto summary = Adjust(&model);
  EXPECT_THAT(summary.warnings,
              testing::Contains(HasSubstr("more than the print tolerance of 0.10 %")));
  EXPECT_GT(summary.uncertainty.relative_scale_sigma, 0.02 / std::sqrt(48.0) / 2);
}

TEST_F(MarkerAdjustment, ScaleBarWinsOverPoorMarkers) {
  // The printer scaled all by 1 %; the layout allows for it and knows one distance.
  const double length_m = 1.01 * (scene_.x_in_world.at(0)[0] - scene_.x_in_world.at(11)[0]).norm();
  scene_.layout.distances = {{0, 0, 11, 0, length_m, 1e-4, true}};
  MarkerAdjustmentOptions options;
  options.common_print_tolerance = 0.01;
  Model model = NoisyModel(0.05, 9);
  const auto summary = Adjust(&model, options);
  EXPECT_THAT(summary.warnings, IsEmpty());
  const auto center = [&model](int marker_id) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int c = 1; c <= 4; ++c) sum += model.points3D.at(10 * marker_id + c).x_in_world;
    return Eigen::Vector3d(sum / 4);
  };
  EXPECT_NEAR((center(0) - center(11)).norm(), length_m, 3e-4);
  EXPECT_LT(summary.uncertainty.relative_scale_sigma, 1e-3);
  EXPECT_EQ(summary.uncertainty.print_scale_sigma, 0.0);
  scene_.layout.distances.clear();
  Model without = NoisyModel(0.05, 9);
  const AdjustmentUncertainty by_markers = Adjust(&without, options).uncertainty;
  EXPECT_GT(by_markers.relative_scale_sigma, 0.0099);
  EXPECT_EQ(by_markers.print_scale_sigma, 0.01);
}

TEST_F(MarkerAdjustment, ScaleBarThatIsGrosslyWrongIsReportedAndNotUsed) {
  const double length_m = 1.3 * (scene_.x_in_world.at(0)[2] - scene_.x_in_world.at(11)[0]).norm();
  scene_.layout.distances = {{0, 2, 11, 0, length_m, 1e-4, true}};
  Model model = NoisyModel(0.05, 9), plain = model;
  const auto summary = Adjust(&model);
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_THAT(summary.warnings[0],
              HasSubstr("from corner 2 of marker 0 to the centre of marker 11"));
  scene_.layout.distances[0].is_scale_bar = false;
  EXPECT_THAT(Adjust(&plain).warnings, IsEmpty());
  EXPECT_EQ(Bytes(plain), Bytes(model));
}

TEST_F(MarkerAdjustment, IntrinsicsAreRefinedWithTheCalibrationAsPrior) {
  Model model = NoisyModel(0.02, 10);
  const std::vector<double> truth = truth_.cameras.at(1).params;
  model.cameras.at(1).params[0] *= 1.005;
  model.cameras.at(1).params[1] *= 1.005;
  const auto wrong = model.cameras.at(1).params;
  MarkerAdjustmentOptions options;
  options.refine_focal_length = true;
  Adjust(&model, options);
  const std::vector<double>& refined = model.cameras.at(1).params;
  EXPECT_NEAR(refined[0] / truth[0], 1.0, 1.5e-3);
  EXPECT_NEAR(refined[1] / truth[1], 1.0, 1.5e-3);
  for (std::size_t i = 2; i < 8; ++i) EXPECT_EQ(refined[i], wrong[i]);
}

TEST_F(MarkerAdjustment, TooLittleIsADataErrorAndLeavesTheModel) {
  Model single = truth_;
  single.images.resize(1);
  for (auto& [point3D_id, point] : single.points3D) {
    point.track.erase(std::remove_if(point.track.begin(), point.track.end(),
                                     [](const TrackElement& e) { return e.image_id != 1; }),
                      point.track.end());
  }
  const std::string before = Bytes(single);
  EXPECT_THROW(Adjust(&single), DataError);
  EXPECT_EQ(Bytes(single), before);
  Model empty;
  EXPECT_THROW(Adjust(&empty), DataError);
}

TEST_F(MarkerAdjustment, ErrorsAboveTheLimitAreADataError) {
  Model model = NoisyModel(3.0, 2);
  const std::string before = Bytes(model);
  MarkerAdjustmentOptions options;
  options.max_mean_error_px = 2.0;
  ExpectThrows<DataError>([&] { Adjust(&model, options); }, {"--BundleAdjustment.max_mean_error"});
  EXPECT_EQ(Bytes(model), before);
}

TEST_F(MarkerAdjustment, PointsThatAreNoMarkerCornersAreADataError) {
  Model model = truth_;
  auto node = model.points3D.extract(11);
  node.key() = 19;
  for (const TrackElement& element : node.mapped().track) {
    for (ModelImage& image : model.images) {
      if (image.image_id == element.image_id) image.points2D[element.point2D_idx].point3D_id = 19;
    }
  }
  model.points3D.insert(std::move(node));
  EXPECT_THROW(Adjust(&model), DataError);
}

TEST(MarkerAdjustmentOptions, EveryRangeIsCheckedByName) {
  const auto message = [](auto set) {
    MarkerAdjustmentOptions options;
    set(&options);
    try {
      options.Check();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message([](auto*) {}), "");
  EXPECT_THAT(message([](auto* o) { o->print_tolerance = 0; }),
              HasSubstr("--MarkerAdjustment.print_tolerance: 0"));
  EXPECT_THAT(message([](auto* o) { o->corner_sigma_px = std::nan(""); }),
              HasSubstr("--MarkerAdjustment.corner_sigma"));
  EXPECT_THAT(message([](auto* o) { o->outlier_sigmas = 1; }),
              HasSubstr("--MarkerAdjustment.outlier: 1 "));
  EXPECT_THAT(message([](auto* o) { o->rolling_shutter_s = -0.2; }),
              HasSubstr("--MarkerAdjustment.rolling_shutter"));
}

TEST(CornerErrorsOf, FollowsTheKeypointsAndDoubtsFallbacks) {
  DatabaseImage image;
  image.image_id = 3;
  image.detections.markers.resize(2);
  image.detections.markers[0].corner_sigma_px = {0.1, 0.2, 0.3, 0.4};
  image.detections.markers[1].is_fallback = true;
  FormationEstimate formation;
  formation.inset_sigma_px = 0.02;
  const CornerErrors errors = CornerErrorsOf({image}, formation);
  EXPECT_EQ(errors.common_inset_px, 0.02);
  EXPECT_THAT(errors.motions, IsEmpty());
  const double fallback = 5 * MarkerAdjustmentOptions{}.corner_sigma_px;
  EXPECT_THAT(errors.sigmas_px.at(3),
              ElementsAre(0.1, 0.2, 0.3, 0.4, fallback, fallback, fallback, fallback));
}

}  // namespace
}  // namespace velamap
