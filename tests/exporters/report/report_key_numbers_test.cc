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
