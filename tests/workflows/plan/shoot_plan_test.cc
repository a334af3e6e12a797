#include "workflows/plan/shoot_plan.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exporters/shape/shape_sigma.h"
#include "importer/base/error.h"
#include "importer/geometry/units.h"
#include "tests/support/error_matchers.h"
#include "tests/workflows/plan/plan_example.h"
#include "workflows/plan/plan_writer.h"

namespace velamap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

PlannedSurface FlatSquare() {
  const Placement placement = PlaceOnGrid({1, 1, {}}, 100, 150, 0);
  Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  layout.parts = {PartOfPlacement(placement)};
  return SurfaceOfPlacement(placement, layout, 0, 0);
}

TEST(PlannedViewTest, SizesFollowDistanceAndAngle) {
  const PlannedSurface square = FlatSquare();
  const auto view_at = [&](double distance_m, double angle_deg) {
    const auto views =
        SeeMarkers(square, LinearCamera(), CameraAt(square, {distance_m, 0, 0, 1}, angle_deg));
    EXPECT_EQ(views.size(), 1u);
    return views.front();
  };
  EXPECT_NEAR(view_at(5, 0).side_px, 20.0, 0.01);
  EXPECT_NEAR(view_at(10, 0).side_px, 10.0, 0.01);
  EXPECT_NEAR(view_at(10, 60).narrow_px, 5.0, 0.05);
  EXPECT_GT(view_at(5, 0).found_share, 0.99);
  // The share of studies/results/shooting.csv at this size is 0.73.
  EXPECT_NEAR(view_at(10, 0).found_share, 0.73, 0.1);
  EXPECT_LT(view_at(12, 0).found_share, 0.5);
  EXPECT_LT(view_at(12, 60).found_share, 0.01);
}

TEST(PlannedViewTest, BacksAndWhatIsOutsideAreNotSeen) {
  const PlannedSurface square = FlatSquare();
  EXPECT_TRUE(SeeMarkers(square, LinearCamera(), CameraAt(square, {5, 0, 0, 1}, 180)).empty());
  EXPECT_TRUE(SeeMarkers(square, LinearCamera(), CameraAt(square, {0.08, 0, 0, 1}, 0)).empty());
}

TEST(PlannedViewTest, AnglesSpanTheArc) {
  const std::vector<double> angles_deg = AnglesOf({5, 80, 0, 5});
  EXPECT_THAT(angles_deg, ::testing::ElementsAre(-40, -20, 0, 20, 40));
}

TEST(CameraOfFieldOfViewTest, BordersLieAtHalfTheAngle) {
  ShootPlanOptions options;
  options.field_of_view_deg = 100;
  for (const LensMode lens : {LensMode::kLinear, LensMode::kWide}) {
    options.lens = lens;
    const Camera camera = CameraOfFieldOfView(options);
    const auto ray = CamFromImage(camera, {0, 540});
    ASSERT_TRUE(ray);
    EXPECT_NEAR(kDegPerRad * std::atan(-ray->x()), 50, 1e-6);
  }
  options.lens = LensMode::kLinear;
  options.field_of_view_deg = 170;
  ExpectThrows<InputError>([&] { CameraOfFieldOfView(options); },
                           {"--field_of_view", "--lens wide"});
  options.field_of_view_deg.reset();
  ExpectThrows<InputError>([&] { CameraOfFieldOfView(options); }, {"--camera_path: missing"});
}

TEST(SimulatePlanTest, ShapeFollowsTheCornersAndTheNumberOfViews) {
  const PlannedSurface sail = PlannedSail();
  const auto shape_sigma = [&](double corner_sigma_px, int num_views) {
    ShootPlanOptions options;
    options.corner_sigma_px = corner_sigma_px;
    return SimulatePlan(sail, LinearCamera(), {4, 80, 1, num_views}, options)
        .distance_after_scaling_sigma_mm;
  };
  const double sigma_mm = shape_sigma(0.2, 15);
  EXPECT_NEAR(shape_sigma(0.4, 15) / sigma_mm, 2.0, 0.3);
  EXPECT_NEAR(shape_sigma(0.2, 60) / sigma_mm, 0.5, 0.1);
}

TEST(SimulatePlanTest, OneMarkerInOneViewGivesNoShape) {
  EXPECT_THROW(SimulatePlan(FlatSquare(), LinearCamera(), {5, 0, 0, 1}, {}), DataError);
}

TEST(ShootPlanTest, ChoosesADistanceAndSaysWhatItGives) {
  ShootPlanOptions options;
  options.num_views = 12;
  const ShootPlan plan = MakeShootPlan(PlannedSail(), LinearCamera(), options);
  EXPECT_GT(plan.along_path.found_share, 0.8);
  ASSERT_TRUE(plan.plan().precision);
  EXPECT_GT(MedianSigma(plan.plan().precision->marker_sigma_mm), 0.1);
  EXPECT_LT(plan.shutters[1].motion_px_s, plan.shutters[0].motion_px_s);
  EXPECT_GT(plan.shutters[1].exposure_s, plan.shutters[2].exposure_s);
  std::ostringstream out, csv, markers, again;
  PrintPlan(plan, out);
  EXPECT_EQ(out.str().rfind("verdict: ", 0), 0u);
  EXPECT_THAT(out.str(), HasSubstr("\nrecommendation: go 90 degrees around"));
  WritePlanCsv(plan, csv);
  WriteMarkersCsv(plan, markers);
  WriteMarkersCsv(MakeShootPlan(PlannedSail(), LinearCamera(), options), again);
  EXPECT_EQ(markers.str(), again.str());
  EXPECT_THAT(csv.str(), HasSubstr("\nshutter,"));
}

// Markers are narrowest at the ends of a wide arc, and have to be sharp there too.
TEST(ShootPlanTest, ShutterSuitsTheEndsOfTheArc) {
  ShootPlanOptions options;
  options.num_views = 12;
  options.arc_deg = 150;
  const ShootPlan plan = MakeShootPlan(PlannedSail(), LinearCamera(), options);
  int num_compared = 0;
  for (const PlannedView& view : plan.views) {
    if (view.distance_m != plan.path.distance_m) continue;
    EXPECT_LE(plan.shutters.front().exposure_s, view.exposure_s) << view.angle_deg;
    ++num_compared;
  }
  EXPECT_EQ(num_compared, 3);
}

// A path that determines no depth is not recommended, but the one that does.
TEST(ShootPlanTest, BadPathIsNotRecommended) {
  ShootPlanOptions options;
  options.num_views = 12;
  options.arc_deg = 0;
  const ShootPlan plan = MakeShootPlan(PlannedSail(), LinearCamera(), options);
  ASSERT_EQ(JudgePlan(plan).level, ReportStatus::kBad);
  ASSERT_TRUE(plan.recommended);
  EXPECT_THAT(RecommendationText(plan),
              AllOf(HasSubstr("go 90 degrees"), HasSubstr("--Plan.arc 90 --Plan.distance")));
  options.arc_deg = plan.recommended->path.arc_deg;
  options.num_views = plan.recommended->path.num_views;
  options.distance_m = plan.recommended->path.distance_m;
  EXPECT_NE(JudgePlan(MakeShootPlan(PlannedSail(), LinearCamera(), options)).level,
            ReportStatus::kBad);
}

TEST(RecommendationTextTest, ThereIsNoneWhereNoPathIsBetter) {
  EXPECT_EQ(RecommendationText(ShootPlan()).rfind("none", 0), 0u);
}

TEST(ShootPlanTest, DistanceWithoutMarkersIsRefusedWithABetterOne) {
  ShootPlanOptions options;
  options.distance_m = 60;
  ExpectThrows<InputError>([&] { MakeShootPlan(PlannedSail(), LinearCamera(), options); },
                           {"--Plan.distance: from 60 m", "give such as"});
}

TEST(JudgePlanTest, NarrowArcsAndSmallMarkersAreNamed) {
  ShootPlan plan;
  plan.camera = LinearCamera();
  plan.path = {5, 5, 1, 10};
  plan.along_path = {1.0, 0.6, 15, 15};
  plan.shutters = {{1, 100, 0.01}};
  plan.variants = {{"plan", plan.path, std::nullopt, "two views needed"}};
  const Verdict verdict = JudgePlan(plan);
  EXPECT_EQ(verdict.level, ReportStatus::kBad);
  EXPECT_EQ(verdict.reasons.size(), 4u);
}

TEST(JudgePlanTest, RemediesFitTheirCauses) {
  ShootPlan plan;
  plan.surface = PlannedSail();
  plan.camera = LinearCamera();
  plan.along_path = {1.0, 1.0, 40, 40};
  plan.shutters = {{1, 100, 0.01}};
  const auto text = [&](double distance_m) {
    plan.path = {distance_m, 80, 1, 10};
    plan.variants = {{"plan", plan.path, PlanPrecision(), ""}};  // no marker is reached
    std::string texts;
    for (const VerdictReason& reason : JudgePlan(plan).reasons) texts += reason.text + "\n";
    return texts;
  };
  EXPECT_THAT(text(12), AllOf(HasSubstr("they are too small: 0-"), HasSubstr("go closer"),
                              Not(HasSubstr("farther"))));
  EXPECT_THAT(text(1),
              AllOf(HasSubstr("they are outside the picture: "),
                    HasSubstr("go farther away or use a wider lens"), Not(HasSubstr("closer"))));
  EXPECT_THAT(text(-5), AllOf(HasSubstr("they are turned away from the camera: 0-"),
                              Not(HasSubstr("closer")), Not(HasSubstr("farther"))));
  plan.surface.markers_left_out = {7};
  EXPECT_THAT(text(5), HasSubstr("give --shape_path"));
  plan.surface.is_of_shape = true;
  EXPECT_THAT(text(5), HasSubstr("the shape does not hold them: 7"));
}

// Markers leave the picture from any closer by, so larger ones have to be printed.
TEST(JudgePlanTest, GoingCloserIsNoRemedyWhereMarkersFillThePicture) {
  ShootPlan plan;
  plan.surface = PlannedSail();
  plan.camera = LinearCamera();
  plan.along_path = {1.0, 0.7, 18, 18};
  plan.path = {3, 80, 1, 10};
  plan.shutters = {{1, 100, 0.01}};
  plan.variants = {{"plan", plan.path, std::nullopt, "two views needed"}};
  std::string texts;
  for (const VerdictReason& reason : JudgePlan(plan).reasons) texts += reason.text + "\n";
  EXPECT_THAT(texts, AllOf(HasSubstr("smaller than 18 px: film with more pixels"),
                           Not(HasSubstr("closer"))));
}

// A camera of 60 degrees has to go farther away for all of this sail than to find most markers.
TEST(ShootPlanTest, ChosenDistanceHoldsAllMarkersInThePicture) {
  SailPlacementOptions sail;
  sail.luff_m = 6;
  sail.foot_m = 3;
  sail.leech_m = 6.2;
  const Placement placement = PlaceOnSail(sail, 100, 150, 0);
  Layout layout = MakeLayout("DICT_4X4_250", 0.1);
  layout.parts = {PartOfPlacement(placement)};
  ShootPlanOptions options;
  options.field_of_view_deg = 60;
  options.num_views = 12;
  const ShootPlan plan = MakeShootPlan(SurfaceOfPlacement(placement, layout, 0.1, 10),
                                       CameraOfFieldOfView(options), options);
  for (const double angle_deg : AnglesOf(plan.path)) {
    EXPECT_TRUE(MarkersOutsidePicture(plan.surface, plan.camera,
                                      CameraAt(plan.surface, plan.path, angle_deg))
                    .empty())
        << angle_deg;
  }
  EXPECT_GT(plan.along_path.in_picture_share, 0.99);
  EXPECT_GT(plan.along_path.found_share, 0.8);
  for (const VerdictReason& reason : JudgePlan(plan).reasons) {
    EXPECT_THAT(reason.text, Not(HasSubstr("closer")));
  }
}

}  // namespace
}  // namespace velamap
