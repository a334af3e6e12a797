#include "reconstruct/sizes/scale_bar_verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "importer/geometry/alignment.h"
#include "reconstruct/adjust/marker_adjuster.h"
#include "reconstruct/adjust/marker_adjustment.h"
#include "tests/reconstruct/scene_model.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kTapeSigma_m = 0.002;

// A surface of 4 by 2.4 m; its markers are printed `print_scale` times as large as the layout says.
SyntheticScene WrongPrint(double print_scale) {
  SyntheticSceneOptions options;
  options.num_rows = 4;
  options.num_columns = 6;
  options.num_frames = 12;
  options.spacing_m = 0.8;
  SyntheticScene scene = MakeSyntheticScene(options);
  const auto points = scene.x_in_world;
  for (const auto& [marker_id, unused] : points) ResizeMarker(marker_id, print_scale, &scene);
  return scene;
}

double TrueDistance(const SyntheticScene& scene, int id1, int id2) {
  return (scene.x_in_world.at(id1)[0] - scene.x_in_world.at(id2)[0]).norm();
}

struct Outcome {
  double scale_error = 0.0;  // fraction
  double rms_m = 0.0;        // of the corners after a rigid alignment
  MarkerAdjustmentSummary summary;
};

class MeasuredDistances : public testing::Test {
 protected:
  // Far markers: corners of the sheet and its diagonals.
  static constexpr std::array<std::pair<int, int>, 4> kPairs = {
      {{0, 23}, {5, 18}, {0, 5}, {18, 23}}};

  void Measure(std::size_t num_distances, double tape_error_sigmas = 0.0, std::uint32_t seed = 0) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < num_distances; ++i) {
      const auto [id1, id2] = kPairs[i];
      const double error_m = tape_error_sigmas * kTapeSigma_m * normal(random);
      scene_.layout.distances.push_back(
          {id1, 0, id2, 0, TrueDistance(scene_, id1, id2) + error_m, kTapeSigma_m, true});
    }
  }

  Outcome Adjust(std::uint32_t seed = 1) const {
    SyntheticScene noisy = scene_;
    AddNoise({0.03, 0, 0, 200, seed}, &noisy);
    Model model = MakeSceneModel(noisy);
    Outcome outcome;
    outcome.summary = AdjustWithMarkers({}, noisy.layout, {}, &model);
    std::vector<Eigen::Vector3d> x_in_world, x_in_truth;
    for (const auto& [point3D_id, point] : model.points3D) {
      const CornerId id = CornerFromPoint3DId(point3D_id);
      x_in_world.push_back(point.x_in_world);
      x_in_truth.push_back(scene_.x_in_world.at(id.marker_id)[id.corner]);
    }
    outcome.scale_error = EstimateSim3(x_in_truth, x_in_world).scale - 1.0;
    const Rigid3 world_from_truth = EstimateRigid3(x_in_truth, x_in_world);
    double sum = 0.0;
    for (std::size_t i = 0; i < x_in_truth.size(); ++i) {
      sum += (x_in_world[i] - world_from_truth * x_in_truth[i]).squaredNorm();
    }
    outcome.rms_m = std::sqrt(sum / static_cast<double>(x_in_truth.size()));
    return outcome;
  }

  SyntheticScene scene_ = WrongPrint(1.008);
};

TEST_F(MeasuredDistances, ThatAgreeOverruleTheMarkers) {
  const Outcome without = Adjust();
  EXPECT_NEAR(without.scale_error, -0.008, 5e-4);
  Measure(4, 1.0);
  const Outcome with = Adjust();
  const double sigma = with.summary.uncertainty.relative_scale_sigma;
  EXPECT_LT(std::abs(with.scale_error), 3 * sigma);
  EXPECT_LT(sigma, 5e-4);
  EXPECT_LT(5 * with.rms_m, without.rms_m);
  ASSERT_THAT(with.summary.warnings, SizeIs(1));
  EXPECT_THAT(with.summary.warnings[0],
              AllOf(HasSubstr("the measured distances make the markers 0."),
                    HasSubstr("larger than marker_length: the distances are used"),
                    HasSubstr("check the printed size (marker_length) or whether the camera's")));
}

TEST_F(MeasuredDistances, ThatAgreeWithTheMarkersChangeNoPrior) {
  scene_ = WrongPrint(1.0);
  Measure(4, 1.0);
  EXPECT_THAT(Adjust().summary.warnings, IsEmpty());
}

TEST_F(MeasuredDistances, TheOneThatContradictsTheOthersIsNamedAndLeftOut) {
  Measure(4);
  const Outcome right = Adjust();
  scene_.layout.distances[2].length_m *= 1.03;
  const Outcome outcome = Adjust();
  ASSERT_THAT(outcome.summary.warnings, SizeIs(2));
  EXPECT_THAT(outcome.summary.warnings[0],
              AllOf(HasSubstr("from the centre of marker 0 to the centre of marker 5 is"),
                    HasSubstr("by the other measured distances"), HasSubstr("it is not used")));
  EXPECT_THAT(outcome.summary.warnings[1], HasSubstr("the measured distances make"));
  scene_.layout.distances.erase(scene_.layout.distances.begin() + 2);
  EXPECT_EQ(outcome.scale_error, Adjust().scale_error);
  EXPECT_NEAR(outcome.scale_error, right.scale_error, 3e-4);
}

TEST_F(MeasuredDistances, ASingleOneIsRightAboutTheScale) {
  Measure(1);
  const Outcome outcome = Adjust();
  EXPECT_LT(std::abs(outcome.scale_error), 3 * outcome.summary.uncertainty.relative_scale_sigma);
  EXPECT_LT(outcome.summary.uncertainty.relative_scale_sigma, 1e-3);
  ASSERT_THAT(outcome.summary.warnings, SizeIs(1));
  EXPECT_THAT(outcome.summary.warnings[0], HasSubstr("the measured distance makes the markers 0."));
}

TEST_F(MeasuredDistances, ASingleOneThatIsGrosslyWrongIsRefusedWithTheReason) {
  const Outcome without = Adjust();
  Measure(1);
  scene_.layout.distances[0].length_m *= 1.3;
  const Outcome outcome = Adjust();
  ASSERT_THAT(outcome.summary.warnings, SizeIs(1));
  EXPECT_THAT(outcome.summary.warnings[0],
              AllOf(HasSubstr("from the centre of marker 0 to the centre of marker 23"),
                    HasSubstr("it is not used"), HasSubstr("check its unit, ids and corners")));
  EXPECT_EQ(outcome.scale_error, without.scale_error);
}

TEST_F(MeasuredDistances, InAnotherUnitAreRefused) {
  Measure(4);
  for (KnownDistance& distance : scene_.layout.distances) distance.length_m /= 0.0254;
  const Outcome outcome = Adjust();
  EXPECT_THAT(outcome.summary.warnings, SizeIs(4));
  EXPECT_THAT(outcome.summary.warnings, Each(HasSubstr("check the unit")));
}

// A side typed twice as long as it is: the distances know better.
TEST_F(MeasuredDistances, CorrectAMarkerLengthThatIsTwiceTooLong) {
  Measure(4);
  scene_.layout.marker_length_m *= 2.0;
  const Outcome outcome = Adjust();
  EXPECT_LT(std::abs(outcome.scale_error), 3 * outcome.summary.uncertainty.relative_scale_sigma);
  EXPECT_LT(outcome.rms_m, 0.004);
}

TEST_F(MeasuredDistances, OfTwoTheMarkersBelieveTheNearer) {
  scene_ = WrongPrint(1.0);
  Measure(2);
  scene_.layout.distances[1].length_m *= 1.01;
  const Outcome outcome = Adjust();
  ASSERT_THAT(outcome.summary.warnings, SizeIs(1));
  EXPECT_THAT(outcome.summary.warnings[0],
              AllOf(HasSubstr("from the centre of marker 5 to the centre of marker 18"),
                    HasSubstr("it is not used")));
  EXPECT_NEAR(outcome.scale_error, 0.0, 1e-3);
  // Neither agrees with the markers nor with the other.
  scene_.layout.distances[0].length_m *= 0.98;
  const Outcome neither = Adjust();
  ASSERT_THAT(neither.summary.warnings, SizeIs(2));
  EXPECT_THAT(neither.summary.warnings, Each(HasSubstr("contradict each other")));
}

// Whatever the error of the print, sigmas of the scale are those of the distances. Of four, one is
// wrong by 3 %.
TEST_F(MeasuredDistances, GiveAScaleWithinItsSigmaAsOftenAsItShould) {
  constexpr int kNumDraws = 100;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> print_error(-0.02, 0.02);
  double sum = 0.0;
  int num_within_2 = 0;
  for (std::uint32_t draw = 0; draw < kNumDraws; ++draw) {
    scene_ = WrongPrint(1.0 + print_error(random));
    Measure(1 + draw % 4, 1.0, 100 + draw);
    const bool has_mistake = scene_.layout.distances.size() == 4;
    if (has_mistake) scene_.layout.distances[draw / 4 % 4].length_m *= draw % 8 == 3 ? 1.03 : 0.97;
    const Outcome outcome = Adjust(200 + draw);
    const auto num_left_out = std::count_if(
        outcome.summary.warnings.begin(), outcome.summary.warnings.end(), [](const auto& warning) {
          return warning.find("by the other measured distances") != std::string::npos;
        });
    EXPECT_EQ(num_left_out, has_mistake ? 1 : 0) << draw;
    const double z = outcome.scale_error / outcome.summary.uncertainty.relative_scale_sigma;
    sum += z * z;
    num_within_2 += std::abs(z) < 2;
  }
  const double rms = std::sqrt(sum / kNumDraws);  // of 100 draws: 1 +- 0.07
  RecordProperty("rms", std::to_string(rms));
  EXPECT_GT(rms, 0.8);
  EXPECT_LT(rms, 1.2);
  EXPECT_GE(num_within_2, 90);
}

// The bars are added, then the corners of a marker become outliers: their sigmas are made so small
// that no place of them fits.
class BarsOfAShrinkingModel : public MeasuredDistances {
 protected:
  BarsOfAShrinkingModel() {
    for (const auto& [id1, id2] : {std::pair{8, 18}, {18, 23}}) {
      scene_.layout.distances.push_back(
          {id1, 0, id2, 0, TrueDistance(scene_, id1, id2), kTapeSigma_m, true});
    }
  }

  void AdjustWithOutliers(int marker_id, const std::set<int>& corners) {
    SyntheticScene noisy = scene_;
    AddNoise({0.03, 0, 0, 200, 1}, &noisy);
    model_ = MakeSceneModel(noisy);
    CornerErrors errors;
    for (const ModelImage& image : model_.images) {
      errors.sigmas_px[image.image_id].assign(image.points2D.size(), 0.03);
    }
    MarkerAdjustmentOptions options;
    options.corner_sigma_floor_px = 0.0;
    options.min_track_length = 4;  // some point always fits two images
    options.loss_sigmas = 1.0;     // so that poses do not follow the outliers
    MarkerAdjuster adjuster(options, noisy.layout, errors, model_);
    adjuster.PrepareSeed();
    adjuster.AdjustFromSeed();
    ASSERT_TRUE(adjuster.AddScaleBars());
    for (const int corner : corners) {
      for (const auto& [image_id, idx] : model_.points3D.at(10 * marker_id + corner).track) {
        errors.sigmas_px.at(image_id)[idx] = 1e-3;
      }
    }
    adjuster.AdjustWithSizes();
    adjuster.Finish();
    model_ = adjuster.TakeModel();
    summary_ = adjuster.TakeSummary();
  }

  Eigen::Vector3d Center(int marker_id) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int c = 1; c <= kNumCorners; ++c) {
      sum += model_.points3D.at(10 * marker_id + c).x_in_world;
    }
    return sum / kNumCorners;
  }

  void ExpectMeasured(const KnownDistance& distance) const {
    const double length_m = (Center(distance.marker_id1) - Center(distance.marker_id2)).norm();
    EXPECT_NEAR(length_m, distance.length_m, 2 * kTapeSigma_m);
  }

  Model model_;
  MarkerAdjustmentSummary summary_;
};

TEST_F(BarsOfAShrinkingModel, StayAtTheirMarkersWhenOneBeforeThemIsLost) {
  AdjustWithOutliers(3, {1, 2, 3, 4});
  ASSERT_EQ(model_.points3D.count(31), 0u);
  for (const KnownDistance& distance : scene_.layout.distances) ExpectMeasured(distance);
  EXPECT_LT(summary_.uncertainty.relative_scale_sigma, 1e-3);
  EXPECT_THAT(summary_.warnings, Each(HasSubstr("the measured distances make")));
}

TEST_F(BarsOfAShrinkingModel, AreLeftOutWithAWarningWhenTheyLoseACorner) {
  AdjustWithOutliers(8, {2});
  ASSERT_EQ(model_.points3D.count(82), 0u);
  ASSERT_EQ(model_.points3D.count(83), 1u);
  ExpectMeasured(scene_.layout.distances[1]);
  EXPECT_THAT(summary_.warnings,
              Contains(AllOf(HasSubstr("from the centre of marker 8 to the centre of marker 18"),
                             HasSubstr("is not used after all"))));
}

TEST_F(BarsOfAShrinkingModel, LeaveTheirScaleAndItsUncertaintyWhenAllAreLost) {
  AdjustWithOutliers(18, {3});
  ASSERT_EQ(model_.points3D.count(183), 0u);
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("is not used after all")).Times(2));
  EXPECT_GT(summary_.uncertainty.relative_scale_sigma, 0.005);
}

}  // namespace
}  // namespace velamap
