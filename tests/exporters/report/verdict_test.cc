#include "exporters/report/verdict.h"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>

#include "reconstruct/model/weak_geometry.h"
#include "tests/exporters/report/report_example.h"

namespace velamap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

KeyNumber Number(KeyNumberKind kind, ReportStatus status) {
  return {kind, "3 px", "meaning", status, "do this"};
}

// A calibration that the residuals contradict by far.
AdjustmentUncertainty Doubtful(double focal_share, double distortion_share) {
  AdjustmentUncertainty uncertainty;
  CalibrationEvidence& evidence = uncertainty.calibration;
  evidence.num_changes = 8;
  evidence.chi_squared = 5000;
  evidence.focal_share = focal_share;
  evidence.distortion_share = distortion_share;
  evidence.systematic_px = 0.2;
  evidence.focal_change = -0.0909;
  evidence.shape_change_in_sigmas = 4;
  return uncertainty;
}

TEST(Verdict, IsGoodWithoutAReason) {
  const Verdict verdict = MakeVerdict({Number(KeyNumberKind::kScale, ReportStatus::kGood),
                                       Number(KeyNumberKind::kSize, ReportStatus::kNone)},
                                      {});
  EXPECT_EQ(verdict.level, ReportStatus::kGood);
  EXPECT_THAT(verdict.reasons, IsEmpty());
  std::ostringstream out;
  PrintVerdict(verdict, out);
  EXPECT_EQ(out.str(), "verdict: good\n");
}

TEST(Verdict, BadComesBeforeCheckAndCausesBeforeEffectsAndWarningsLast) {
  const Verdict verdict =
      MakeVerdict({Number(KeyNumberKind::kMarkers, ReportStatus::kBad),
                   Number(KeyNumberKind::kReprojectionError, ReportStatus::kCheck),
                   Number(KeyNumberKind::kCalibration, ReportStatus::kBad),
                   Number(KeyNumberKind::kScale, ReportStatus::kCheck)},
                  {"a warning", "another", "a warning"});
  std::ostringstream out;
  PrintVerdict(verdict, out);
  EXPECT_EQ(out.str(),
            "verdict: bad\n"
            "verdict_reason: bad; Calibration: 3 px; do this\n"
            "verdict_reason: bad; Markers: 3 px; do this\n"
            "verdict_reason: check; Scale: 3 px; do this\n"
            "verdict_reason: check; Reprojection error: 3 px; do this\n"
            "verdict_reason: check; a warning\n"
            "verdict_reason: check; another\n");
}

TEST(Verdict, AWarningAloneIsToBeChecked) {
  const Verdict verdict = MakeVerdict({}, {"a warning"});
  EXPECT_EQ(verdict.level, ReportStatus::kCheck);
}

TEST(Verdict, NamesTheCalibrationAndOffersTheRefinementThatExplainsIt) {
  const ReportExample example = MakeReportExample(2, 4);
  ReportInput input = example.Input();
  const auto first_reason = [&input](const AdjustmentUncertainty& uncertainty) {
    input.uncertainty = &uncertainty;
    const Verdict verdict = MakeVerdict(input);
    EXPECT_EQ(verdict.level, ReportStatus::kBad);
    return verdict.reasons.empty() ? "" : verdict.reasons.front().text;
  };
  EXPECT_EQ(MakeVerdict(input).level, ReportStatus::kGood);
  EXPECT_THAT(first_reason(Doubtful(0.95, 0.3)), StartsWith("Calibration: 0.200 px"));
  EXPECT_THAT(first_reason(Doubtful(0.95, 0.3)), HasSubstr("does not belong to these images"));
  EXPECT_THAT(first_reason(Doubtful(0.95, 0.3)), HasSubstr("its focal length is 10.0 % too large"));
  EXPECT_THAT(first_reason(Doubtful(0.95, 0.3)),
              HasSubstr("--BundleAdjustment.refine_focal_length 1"));
  EXPECT_THAT(first_reason(Doubtful(0.3, 0.95)),
              HasSubstr("--BundleAdjustment.refine_extra_params 1"));
  EXPECT_THAT(first_reason(Doubtful(0.3, 0.3)), HasSubstr("refine_extra_params"));
  EXPECT_THAT(first_reason(Doubtful(0.3, 0.3)), HasSubstr("refine_focal_length"));
}

// Without a calibration there is none to blame: the clip does not determine the camera.
TEST(Verdict, BlamesTheClipWhereTheCameraWasFoundFromIt) {
  const ReportExample example = MakeReportExample(2, 4);
  ReportInput input = example.Input();
  const AdjustmentUncertainty uncertainty = Doubtful(0.3, 0.95);
  input.uncertainty = &uncertainty;
  const Camera& camera = example.model.cameras.begin()->second;
  input.found_cameras = {{camera, std::vector<double>(camera.params.size(), 1e-3)}};
  const Verdict verdict = MakeVerdict(input);
  ASSERT_EQ(verdict.level, ReportStatus::kBad);
  EXPECT_THAT(verdict.reasons.front().text,
              AllOf(HasSubstr("film from more directions"), HasSubstr("give a calibration"),
                    Not(HasSubstr("refine_extra_params"))));

  const std::string warning =
      "there is hardly any parallax: half of the points are seen within less than 2.5 degrees; "
      "therefore the points are known to 4.4 mm along the line of sight, but to 0.36 mm across it: "
      "take images from places more than 30 degrees apart";
  ASSERT_TRUE(IsWeakGeometryWarning(warning));
  input.warnings = {"another", warning};
  const Verdict with_cause = MakeVerdict(input);
  EXPECT_THAT(with_cause.reasons.front().text, HasSubstr("hardly any parallax"));
  EXPECT_EQ(std::count_if(with_cause.reasons.begin(), with_cause.reasons.end(),
                          [](const VerdictReason& reason) {
                            return reason.text.find("parallax") != std::string::npos;
                          }),
            1);
}

TEST(Verdict, AWarningThatACardRepeatsIsOneReason) {
  KeyNumber number = Number(KeyNumberKind::kSteadiness, ReportStatus::kBad);
  number.advice = "switch stabilization off";
  const Verdict verdict = MakeVerdict({number}, {"switch stabilization off", "another warning"});
  EXPECT_EQ(verdict.level, ReportStatus::kBad);
  ASSERT_EQ(verdict.reasons.size(), 2u);
  EXPECT_EQ(verdict.reasons.back().text, "another warning");
}

TEST(Verdict, AStabilizedOrZoomedClipIsBadWhereItSpoilsTheShape) {
  const ReportExample example = MakeReportExample(2, 4);
  const auto verdict = [&](const SteadinessVerdict& steadiness) {
    ReportInput input = example.Input();
    input.steadiness = steadiness;
    return MakeVerdict(input);
  };
  const FocalStep small{"b.jpg", 1, 960, 980, 20}, large{"b.jpg", 1, 960, 1000, 20};
  EXPECT_EQ(verdict({}).level, ReportStatus::kGood);
  EXPECT_EQ(verdict({small, {}}).level, ReportStatus::kCheck);
  EXPECT_EQ(verdict({large, {}}).level, ReportStatus::kBad);
  EXPECT_EQ(verdict({{}, PrincipalPointWander{8, 960}}).level, ReportStatus::kCheck);
  const Verdict spoilt = verdict({large, PrincipalPointWander{20, 960}});
  EXPECT_EQ(spoilt.level, ReportStatus::kBad);
  EXPECT_THAT(spoilt.reasons.front().text, StartsWith("Camera steadiness: principal point"));
}

TEST(Verdict, AScaleThatRestsOnADoubtfulCalibrationIsNotGreen) {
  const ReportExample example = MakeReportExample(2, 4);
  ReportInput input = example.Input();
  const AdjustmentUncertainty uncertainty = Doubtful(0.9, 0.9);
  input.uncertainty = &uncertainty;
  const std::vector<KeyNumber> numbers = MakeKeyNumbers(input);
  const auto scale = std::find_if(numbers.begin(), numbers.end(), [](const KeyNumber& n) {
    return n.kind == KeyNumberKind::kScale;
  });
  ASSERT_NE(scale, numbers.end());
  EXPECT_EQ(scale->status, ReportStatus::kCheck);
}

TEST(Verdict, IdsThatDoNotFitTogetherAreBlamedOnTheDictionaryBeforeAllElse) {
  const ReportExample example = MakeReportExample(2, 4);
  const auto num_markers = static_cast<int>(example.shape.markers.size());
  ReportInput input = example.Input();
  const AdjustmentUncertainty uncertainty = Doubtful(0.95, 0.3);
  input.uncertainty = &uncertainty;
  input.num_ids_found = 5 * num_markers;
  EXPECT_THAT(MakeVerdict(input).reasons.front().text, StartsWith("Dictionary: "));
  EXPECT_THAT(MakeVerdict(input).reasons.front().text, HasSubstr("check the dictionary"));
  input.uncertainty = nullptr;
  input.num_ids_found = 3 * num_markers;
  EXPECT_EQ(MakeVerdict(input).level, ReportStatus::kCheck);
  input.num_ids_found = num_markers + 1;
  EXPECT_EQ(MakeVerdict(input).level, ReportStatus::kGood);
}

// Neither chance, nor less than the lens residue of every corner, nor what hardly moves the shape.
TEST(Verdict, ACalibrationIsDoubtedOnlyWhereItMatters) {
  const ReportExample example = MakeReportExample(2, 4);
  ReportInput input = example.Input();
  const auto level = [&input](const AdjustmentUncertainty& uncertainty) {
    input.uncertainty = &uncertainty;
    return MakeVerdict(input).level;
  };
  AdjustmentUncertainty by_chance = Doubtful(0.9, 0.9), tiny = by_chance, harmless = by_chance,
                        moderate = by_chance;
  by_chance.calibration.chi_squared = 12;
  tiny.calibration.systematic_px = 0.01;
  harmless.calibration.shape_change_in_sigmas = 0.1;
  moderate.calibration.shape_change_in_sigmas = 0.8;
  EXPECT_EQ(level(by_chance), ReportStatus::kGood);
  EXPECT_EQ(level(tiny), ReportStatus::kGood);
  EXPECT_EQ(level(harmless), ReportStatus::kGood);
  EXPECT_EQ(level(moderate), ReportStatus::kCheck);
}

}  // namespace
}  // namespace velamap
