#include "exporters/datum/known_points_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "importer/base/error.h"
#include "tests/exporters/datum/known_points_fixture.h"
#include "tests/support/error_matchers.h"

namespace velamap {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(KnownPoints, TheNameHasWhatTheFrameRestsOn) {
  MakeShape(7);
  AddCenters(4, 0.0);
  Add(5, 3, 0.0);
  Add(6, 0, 0.0, "z");
  Add(7, 0, 0.0).is_check = true;
  *layout_.known_points[1].x_m[2] += 0.1;  // 2 is left out
  const FrameAttempt attempt = FrameOfKnownPoints(Fit());
  EXPECT_EQ(attempt.frame.value().name, "known points 1 3 4 5.3 6:z");
  EXPECT_THAT(attempt.frame->description, HasSubstr("by 13 coordinates of 5 points; z"));
  const ShapeFrame frame = ChooseFrame(shape_, layout_, std::nullopt, attempt);
  EXPECT_EQ(frame.name, attempt.frame->name);
  EXPECT_TRUE(frame.reasons.empty());
  EXPECT_EQ(FrameText(frame), frame.name + ": " + attempt.frame->description);
  // Another frame can still be asked for, and what is asked for is granted or refused.
  EXPECT_EQ(ChooseFrame(shape_, layout_, FrameChoice{FrameKind::kCamera}, attempt).name, "camera");
  const FrameChoice choice{FrameKind::kKnownPoints};
  ExpectThrows<InputError>(
      [&] {
        ChooseFrame(shape_, layout_, choice, {std::nullopt, "one is on the moon"});
      },
      {"--frame: the frame 'known_points' is not possible: one is on the moon"});
  ExpectThrows<InputError>([&] { CheckFrameChoice(choice, MakeLayout("DICT_4X4_50", 0.1)); },
                           {"--frame: the frame 'known_points'", "the layout has no known_points"});
  layout_.known_points.resize(2);
  ExpectThrows<InputError>(
      [&] { CheckFrameChoice(choice, layout_); },
      {"--frame: the frame 'known_points'", "2 points are given; three are needed"});
}

TEST_F(KnownPoints, WhereTheyGiveNoFrameTheNextOneIsTakenAndSaysWhy) {
  MakeShape(3);
  AddCenters(2, 0.0);
  const ShapeFrame frame = ChooseFrame(shape_, layout_, std::nullopt, FrameOfKnownPoints(Fit()));
  EXPECT_EQ(frame.name, "camera");
  ASSERT_FALSE(frame.reasons.empty());
  EXPECT_EQ(frame.reasons[0], "not by known_points: 2 points are given; three are needed");
}

TEST_F(KnownPoints, MetricsHaveARowOfEachPoint) {
  MakeShape(8);
  AddCenters(5, kSigma_m);
  Add(6, 0, 0.0, "z");
  Add(7, 1, 0.0).is_check = true;
  Add(8, 0, 0.0).is_check = true;
  *layout_.known_points[0].x_m[0] += 0.1;
  *layout_.known_points[6].x_m[1] += 0.1;
  layout_.known_points[7].marker_id = 99;
  MetricsReport report;
  const KnownPointFit fit = Fit();
  AddMetrics(fit, &report);
  const json metrics =
      json::parse(Written([&](std::ostream& out) { WriteMetricsJson(report, out); }));
  EXPECT_EQ(metrics.at("known_point_residual_mm_count"), 5);
  EXPECT_LT(metrics.at("known_point_residual_mm_rms").get<double>(), 6);
  EXPECT_EQ(metrics.at("check_point_error_mm_count"), 1);
  EXPECT_NEAR(metrics.at("check_point_error_mm_max").get<double>(), 100, 15);
  EXPECT_EQ(metrics.at("num_failed_check_points"), 1);
  EXPECT_TRUE(metrics.contains("known_point_growth_sigma_percent"));
  const json& rows = metrics.at("known_points");
  ASSERT_EQ(rows.size(), 8u);
  EXPECT_EQ(rows[0].at("result"), "left out: contradicts the others");
  EXPECT_EQ(rows[1].at("result"), "used");
  EXPECT_EQ(rows[1].at("use"), "frame");
  EXPECT_TRUE(rows[5].contains("dz_mm"));
  EXPECT_FALSE(rows[5].contains("dx_mm"));
  EXPECT_EQ(rows[6].at("point"), "7.1");
  EXPECT_EQ(rows[6].at("result"), "fail");
  EXPECT_EQ(rows[7].at("result"), "not reconstructed");
  EXPECT_FALSE(rows[7].contains("distance_mm"));
  EXPECT_THAT(KnownPointsText(fit), HasSubstr("5 of 6 used"));
  EXPECT_THAT(KnownPointsText(fit), HasSubstr("0 of 2 checks passed, worst 7.1 "));
  // Without redundancy and checks nothing can be bad, and what is not in the shape is not compared.
  KnownPointFit exact = fit;
  exact.points.erase(exact.points.begin() + 4, exact.points.begin() + 7);
  exact.points.erase(exact.points.begin());
  ASSERT_EQ(exact.points.back().state, PointState::kNotInShape);
  exact.points.back().sigmas_off = 1e9;
  EXPECT_THAT(KnownPointsText(exact), Not(HasSubstr("worst 99")));
  exact.residual_in_sigmas.reset();
  EXPECT_THAT(KnownPointsText(exact), Not(HasSubstr("worst")));
  MetricsReport none;
  AddMetrics(KnownPointFit(), &none);
  EXPECT_THAT(none.metrics, IsEmpty());
  EXPECT_THAT(KnownPointWarnings({}), IsEmpty());
}

}  // namespace
}  // namespace velamap
