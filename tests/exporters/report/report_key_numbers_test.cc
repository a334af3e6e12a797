#include "exporters/report/report_key_numbers.h"

#include <limits>
#include <optional>

#include <gmock/gmock.h>

#include "tests/exporters/report/report_example.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::optional<KeyNumber> FindIn(const ReportInput& input, KeyNumberKind kind) {
  for (const KeyNumber& number : MakeKeyNumbers(input)) {
    if (number.kind == kind) return number;
  }
  return std::nullopt;
}

class ReportKeyNumbers : public testing::Test {
 protected:
  KeyNumber Find(KeyNumberKind kind) const { return FindIn(example_.Input(), kind).value(); }

  ReportExample example_ = MakeReportExample(2, 4);
};

TEST_F(ReportKeyNumbers, AGoodModelIsCalledGood) {
  EXPECT_EQ(Find(KeyNumberKind::kReprojectionError).status, ReportStatus::kGood);
  EXPECT_THAT(Find(KeyNumberKind::kReprojectionError).value, StartsWith("0.2"));
  EXPECT_EQ(Find(KeyNumberKind::kMarkerAreaError).status, ReportStatus::kGood);
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kGood);
  EXPECT_EQ(Find(KeyNumberKind::kMarkers).status, ReportStatus::kGood);
  EXPECT_THAT(Find(KeyNumberKind::kMarkers).value, StartsWith("26 of 27, 96.3 %"));
}

TEST_F(ReportKeyNumbers, VerdictsFollowTheFigures) {
  example_.model_metrics.error_px.mean = 0.6;
  example_.metrics.area_error_percent.mean = 12;
  example_.metrics.reconstruction_ratio = 0.8;
  example_.scale.relative_spread = 0.031;
  EXPECT_EQ(Find(KeyNumberKind::kReprojectionError).status, ReportStatus::kCheck);
  EXPECT_EQ(Find(KeyNumberKind::kMarkerAreaError).status, ReportStatus::kBad);
  EXPECT_EQ(Find(KeyNumberKind::kMarkers).status, ReportStatus::kCheck);
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kBad);
  example_.model_metrics.error_px.mean = 1.2;
  EXPECT_EQ(Find(KeyNumberKind::kReprojectionError).status, ReportStatus::kBad);
}

TEST_F(ReportKeyNumbers, AreOnlyThereWhereKnown) {
  EXPECT_FALSE(FindIn(example_.Input(), KeyNumberKind::kPrecision));
  example_.shape.markers.front().sigma_m[0] = Eigen::Vector3d(0.002, 0.001, 0.002);
  EXPECT_THAT(Find(KeyNumberKind::kPrecision).value, HasSubstr("3 mm"));
  example_.metrics.reconstruction_ratio.reset();
  EXPECT_EQ(Find(KeyNumberKind::kMarkers).status, ReportStatus::kNone);
}

TEST_F(ReportKeyNumbers, TheScaleSaysWhatIsAssumedForThePrint) {
  example_.scale.relative_sigma = 0.0011;
  EXPECT_THAT(Find(KeyNumberKind::kScale).meaning, Not(HasSubstr("assumed")));
  example_.scale.print_sigma = 0.001;
  EXPECT_THAT(Find(KeyNumberKind::kScale).meaning,
              HasSubstr("; the first contains 0.1 % that is assumed for the print"));
}

TEST_F(ReportKeyNumbers, AMeasuredDistanceThatFailsIsRed) {
  ScaleAudit audit;
  ReportInput input = example_.Input();
  input.audit = &audit;
  EXPECT_FALSE(FindIn(input, KeyNumberKind::kMeasuredDistances));
  const auto find = [&input](KeyNumberKind kind) { return FindIn(input, kind).value(); };
  audit.distances = {{{1, 0, 2, 0, 2.0, 1e-3, false}, 2.002, 1e-3},
                     {{1, 0, 3, 0, 3.0, 1e-3, true}, 3.001, 1e-3}};
  EXPECT_EQ(find(KeyNumberKind::kMeasuredDistances).status, ReportStatus::kGood);
  EXPECT_EQ(find(KeyNumberKind::kScale).status, ReportStatus::kGood);
  audit.distances[1].distance_m = 3.3;  // left out by the adjustment
  EXPECT_EQ(find(KeyNumberKind::kMeasuredDistances).status, ReportStatus::kCheck);
  audit.distances[0].distance_m = 2.008;
  EXPECT_EQ(find(KeyNumberKind::kMeasuredDistances).status, ReportStatus::kBad);
  EXPECT_THAT(find(KeyNumberKind::kMeasuredDistances).value,
              HasSubstr("1 of 1 checks failed, worst 1-2 +8.00 mm (+5.7 sigmas)"));
  EXPECT_EQ(find(KeyNumberKind::kScale).status, ReportStatus::kBad);
  EXPECT_THAT(find(KeyNumberKind::kScale).meaning, HasSubstr("measured distances contradict it"));
  audit.distances.resize(1);
  audit.distances[0].distance_m.reset();
  EXPECT_EQ(find(KeyNumberKind::kMeasuredDistances).status, ReportStatus::kCheck);
}

TEST_F(ReportKeyNumbers, AKnownPointThatFailsIsRed) {
  KnownPointFit fit;
  ReportInput input = example_.Input();
  input.known_points = &fit;
  EXPECT_FALSE(FindIn(input, KeyNumberKind::kKnownPoints));
  const auto status = [&input] { return FindIn(input, KeyNumberKind::kKnownPoints)->status; };
  for (const int id : {1, 2, 3}) {
    fit.points.push_back({KnownPoint{id, 0, {}, 0.002, false}, PointState::kUsed});
  }
  fit.reason = "2 points are given; three are needed";
  EXPECT_EQ(status(), ReportStatus::kCheck);
  EXPECT_EQ(FindIn(input, KeyNumberKind::kKnownPoints)->value, "no frame: " + fit.reason);
  fit.is_contradicted = true;
  EXPECT_EQ(status(), ReportStatus::kBad);
  fit.is_contradicted = false;
  fit.known_from_shape = Rigid3();
  EXPECT_EQ(status(), ReportStatus::kNone);  // no redundancy
  fit.residual_in_sigmas = 1.1;
  EXPECT_EQ(status(), ReportStatus::kGood);
  fit.scale_change = UncertainValue{0.01, 0.004};
  EXPECT_EQ(status(), ReportStatus::kGood);
  fit.scale_change->sigma = 0.003;
  EXPECT_EQ(status(), ReportStatus::kCheck);
  EXPECT_THAT(FindIn(input, KeyNumberKind::kKnownPoints)->value,
              HasSubstr("a change of +1.000 +- 0.300 % in size"));
  fit.scale_change.reset();
  fit.points[1].state = PointState::kLeftOut;
  EXPECT_EQ(status(), ReportStatus::kCheck);
  fit.points[1].state = PointState::kFailed;
  EXPECT_EQ(status(), ReportStatus::kBad);
  fit.points[1].state = PointState::kNotInShape;
  EXPECT_EQ(status(), ReportStatus::kCheck);
}

TEST_F(ReportKeyNumbers, PartsThatDisagreeLeaveTheScaleOpen) {
  ScaleAudit audit;
  audit.parts = {{"hull", 0.0, 5, 0.005, 5e-4}, {"sail", 0.0, 20, -0.005, 5e-4}};
  audit.parts_disagree = true;
  example_.scale.relative_sigma = 0.0026;
  ReportInput input = example_.Input();
  input.audit = &audit;
  const auto scale = [&input] { return FindIn(input, KeyNumberKind::kScale).value(); };
  EXPECT_EQ(scale().status, ReportStatus::kCheck);
  EXPECT_THAT(scale().meaning, HasSubstr("parts disagree: measure a distance on one of them"));
  const CheckedDistance bar{{1, 0, 3, 0, 3.0, 1e-3, true}, 3.001, 1e-3};
  audit.distances = {bar};
  EXPECT_EQ(scale().status, ReportStatus::kGood);
  // A bar that is not in the shape, that no adjustment used, or that it left out decides nothing.
  audit.distances[0].distance_m.reset();
  EXPECT_EQ(scale().status, ReportStatus::kCheck);
  audit.distances = {bar};
  audit.distances[0].sigma_m.reset();
  EXPECT_EQ(scale().status, ReportStatus::kCheck);
  audit.distances = {bar};
  audit.distances[0].distance_m = 3.1;
  EXPECT_EQ(scale().status, ReportStatus::kCheck);
}

TEST_F(ReportKeyNumbers, AModelAdjustedWithOtherMarkerLengthsIsBad) {
  ScaleAudit audit;
  audit.deviation = -0.009;
  audit.deviation_sigma = 1e-4;
  example_.scale.relative_sigma = 0.0011;
  AdjustmentUncertainty uncertainty;
  ReportInput input = example_.Input();
  input.audit = &audit;
  input.uncertainty = &uncertainty;
  const auto scale = [&input] { return FindIn(input, KeyNumberKind::kScale).value(); };
  EXPECT_EQ(scale().status, ReportStatus::kBad);
  EXPECT_THAT(scale().advice, HasSubstr("0.90 % larger than the layout says (8 sigmas)"));
  EXPECT_THAT(scale().advice, HasSubstr("adjust it again with this layout"));
  // A distance that the adjustment used explains it.
  audit.distances = {{{1, 0, 3, 0, 3.0, 1e-3, true}, 3.001, 1e-3}};
  EXPECT_EQ(scale().status, ReportStatus::kGood);
  audit.distances.clear();
  audit.deviation = -0.003;
  EXPECT_EQ(scale().status, ReportStatus::kGood);
  // Without an uncertainty, the markers of this layout have given the scale.
  audit.deviation = -0.009;
  input.uncertainty = nullptr;
  EXPECT_EQ(scale().status, ReportStatus::kGood);
}

// Noise makes sizes differ where few directions show the markers; then no print is to blame.
TEST_F(ReportKeyNumbers, SizesThatNoiseMakesDifferAreBlamedOnTheViews) {
  const std::string warning =
      "there is hardly any parallax: half of the points are seen within less than 1.9 degrees; "
      "therefore the points are known to 3.7 mm along the line of sight, but to 0.17 mm across it";
  ScaleAudit audit;
  audit.markers.resize(2);
  for (MarkerScale& marker : audit.markers) marker.sigma = 0.03;
  example_.scale.relative_spread = 0.031;
  ReportInput input = example_.Input();
  input.audit = &audit;
  const auto scale = [&input] { return FindIn(input, KeyNumberKind::kScale).value(); };
  EXPECT_EQ(scale().status, ReportStatus::kBad);
  EXPECT_THAT(scale().advice, HasSubstr("from places more than 30 degrees apart"));
  input.warnings = {"another", warning};
  EXPECT_EQ(scale().status, ReportStatus::kBad);
  EXPECT_EQ(scale().advice, warning);
  audit.marker_spread = 0.02;
  EXPECT_THAT(scale().advice, HasSubstr("contradict each other"));
  audit.marker_spread = 0.0;
  for (MarkerScale& marker : audit.markers) marker.sigma.reset();
  EXPECT_THAT(scale().advice, HasSubstr("contradict each other"));
}

TEST_F(ReportKeyNumbers, AScaleThatIsHardlyKnownIsNotGood) {
  example_.scale.relative_spread = 0.0;
  example_.scale.relative_sigma = 0.0049;
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kGood);
  example_.scale.relative_sigma = 0.006;
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kCheck);
  EXPECT_THAT(Find(KeyNumberKind::kScale).advice, HasSubstr("measure a distance"));
  example_.scale.relative_sigma = 0.031;
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kBad);
}

TEST_F(ReportKeyNumbers, AScaleOfUnknownSigmaIsNotGood) {
  example_.scale.relative_spread = 0.0;
  example_.scale.relative_sigma.reset();
  example_.scale.num_markers = 1;
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kCheck);
  EXPECT_EQ(Find(KeyNumberKind::kScale).value, "0.00 % spread");
  EXPECT_THAT(Find(KeyNumberKind::kScale).meaning, HasSubstr("the size rests on one marker"));
  EXPECT_THAT(Find(KeyNumberKind::kScale).advice, HasSubstr("the size rests on one marker"));
  EXPECT_THAT(Find(KeyNumberKind::kScale).advice, HasSubstr("measure a distance"));
  example_.scale.num_markers = 26;
  EXPECT_THAT(Find(KeyNumberKind::kScale).advice,
              HasSubstr("the uncertainty of the size is unknown"));
  example_.scale.relative_sigma = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kCheck);
  EXPECT_EQ(Find(KeyNumberKind::kScale).value, "0.00 % spread");
  example_.scale.relative_spread = 0.031;  // which weighs more
  EXPECT_EQ(Find(KeyNumberKind::kScale).status, ReportStatus::kBad);
  EXPECT_THAT(Find(KeyNumberKind::kScale).advice, HasSubstr("contradict each other"));
}

TEST_F(ReportKeyNumbers, ImagesCountThoseLeftOut) {
  ReportInput input = example_.Input();
  EXPECT_EQ(FindIn(input, KeyNumberKind::kImages).value().meaning, "used");
  input.images_left_out = {{"a.jpg", "blurred"}};
  input.images_not_needed = {{"b.jpg", "others are sharper"}};
  EXPECT_EQ(FindIn(input, KeyNumberKind::kImages).value().value, "4 of 6");
}

}  // namespace
}  // namespace velamap
