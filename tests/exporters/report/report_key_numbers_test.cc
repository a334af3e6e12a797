#include "exporters/report/report_key_numbers.h"

#include <algorithm>
#include <stdexcept>

#include <gmock/gmock.h>

#include "tests/exporters/report/report_example.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ReportKeyNumbers : public testing::Test {
 protected:
  KeyNumber Find(const std::string& name) const {
    for (const KeyNumber& number : MakeKeyNumbers(example_.Input())) {
      if (number.name == name) return number;
    }
    throw std::runtime_error("no key number " + name);
  }

  ReportExample example_ = MakeReportExample(2, 4);
};

TEST_F(ReportKeyNumbers, AGoodModelIsCalledGood) {
  EXPECT_EQ(Find("Reprojection error").status, ReportStatus::kGood);
  EXPECT_THAT(Find("Reprojection error").value, StartsWith("0.2"));
  EXPECT_EQ(Find("Marker area error").status, ReportStatus::kGood);
  EXPECT_EQ(Find("Scale").status, ReportStatus::kGood);
  EXPECT_EQ(Find("Markers").status, ReportStatus::kGood);
  EXPECT_THAT(Find("Markers").value, StartsWith("26 of 27, 96.3 %"));
}

TEST_F(ReportKeyNumbers, VerdictsFollowTheFigures) {
  example_.model_metrics.error_px.mean = 0.6;
  example_.metrics.area_error_percent.mean = 12;
  example_.metrics.reconstruction_ratio = 0.8;
  example_.scale.relative_spread = 0.031;
  EXPECT_EQ(Find("Reprojection error").status, ReportStatus::kCheck);
  EXPECT_EQ(Find("Marker area error").status, ReportStatus::kBad);
  EXPECT_EQ(Find("Markers").status, ReportStatus::kCheck);
  EXPECT_EQ(Find("Scale").status, ReportStatus::kBad);
  example_.model_metrics.error_px.mean = 1.2;
  EXPECT_EQ(Find("Reprojection error").status, ReportStatus::kBad);
}

TEST_F(ReportKeyNumbers, AreOnlyThereWhereKnown) {
  EXPECT_THROW(Find("Precision"), std::runtime_error);
  example_.shape.markers.front().sigma_m[0] = Eigen::Vector3d(0.002, 0.001, 0.002);
  EXPECT_THAT(Find("Precision").value, HasSubstr("3 mm"));
  example_.metrics.reconstruction_ratio.reset();
  EXPECT_EQ(Find("Markers").status, ReportStatus::kNone);
}

TEST_F(ReportKeyNumbers, AMeasuredDistanceThatFailsIsRed) {
  ScaleAudit audit;
  const auto find = [&](const std::string& name) {
    ReportInput input = example_.Input();
    input.audit = &audit;
    for (const KeyNumber& number : MakeKeyNumbers(input)) {
      if (number.name == name) return number;
    }
    return KeyNumber{};
  };
  EXPECT_EQ(find("Measured distances").name, "");
  audit.distances = {{{1, 0, 2, 0, 2.0, 1e-3, false}, 2.002, 1e-3},
                     {{1, 0, 3, 0, 3.0, 1e-3, true}, 3.001, 1e-3}};
  EXPECT_EQ(find("Measured distances").status, ReportStatus::kGood);
  EXPECT_EQ(find("Scale").status, ReportStatus::kGood);
  audit.distances[1].distance_m = 3.3;  // left out by the adjustment
  EXPECT_EQ(find("Measured distances").status, ReportStatus::kCheck);
  audit.distances[0].distance_m = 2.008;
  EXPECT_EQ(find("Measured distances").status, ReportStatus::kBad);
  EXPECT_THAT(find("Measured distances").value,
              HasSubstr("1 of 1 checks failed, worst 1-2 +8.00 mm (+5.7 sigmas)"));
  EXPECT_EQ(find("Scale").status, ReportStatus::kBad);
  EXPECT_THAT(find("Scale").meaning, HasSubstr("measured distances contradict it"));
  audit.distances.resize(1);
  audit.distances[0].distance_m.reset();
  EXPECT_EQ(find("Measured distances").status, ReportStatus::kCheck);
}

TEST_F(ReportKeyNumbers, PartsThatDisagreeLeaveTheScaleOpen) {
  ScaleAudit audit;
  audit.parts = {{"hull", 0.0, 5, 0.005, 5e-4}, {"sail", 0.0, 20, -0.005, 5e-4}};
  audit.parts_disagree = true;
  example_.scale.relative_sigma = 0.0026;
  ReportInput input = example_.Input();
  input.audit = &audit;
  const auto scale = [&input] {
    const auto numbers = MakeKeyNumbers(input);
    return *std::find_if(numbers.begin(), numbers.end(),
                         [](const auto& number) { return number.name == "Scale"; });
  };
  EXPECT_EQ(scale().status, ReportStatus::kCheck);
  EXPECT_THAT(scale().meaning, HasSubstr("parts disagree: measure a distance on one of them"));
  audit.distances = {{{1, 0, 3, 0, 3.0, 1e-3, true}, 3.001, 1e-3}};
  EXPECT_EQ(scale().status, ReportStatus::kGood);
}

TEST_F(ReportKeyNumbers, ImagesCountThoseLeftOut) {
  ReportInput input = example_.Input();
  input.images_left_out = {{"a.jpg", "blurred"}};
  const auto numbers = MakeKeyNumbers(input);
  const auto found = std::find_if(numbers.begin(), numbers.end(),
                                  [](const auto& number) { return number.name == "Images"; });
  ASSERT_NE(found, numbers.end());
  EXPECT_EQ(found->value, "4 of 5");
}

}  // namespace
}  // namespace velamap
