#include "exporters/scale/scale_audit_report.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

using nlohmann::json;
using testing::HasSubstr;

ScaleAudit FullAudit() {
  ScaleAudit audit;
  audit.deviation = 1e-4;
  audit.deviation_sigma = 2e-4;
  audit.marker_spread = 3e-3;
  MarkerScale good{4, "sail", 0.1, 0.1, 0.0, 1e-3, 40.0, 0.2};
  MarkerScale bad{9, "hull", 0.1, 0.05, 1.0, 1e-3, 40.0, 200.0};
  audit.markers = {good, bad};
  audit.histogram = {{-0.01, 0.0, 0}, {0.0, 1.0, 2}};
  audit.x_over_y = 1.002;
  audit.x_over_y_sigma = 5e-4;
  audit.parts = {{"hull", 0.0, 1, 0.004, 0.001}, {"sail", 0.0, 1, -0.004, std::nullopt}};
  audit.sizes = {{"", 0.05, 3, 0.002, 0.001}};
  audit.spread.print_um = UncertainValue{12.0, 2.0};
  audit.spread.note = "print only";
  audit.distances = {{{4, 0, 9, 2, 2.0, 1e-3, false}, 2.0029, std::nullopt},
                     {{4, 0, 8, 0, 2.0, 1e-3, true}, std::nullopt, std::nullopt}};
  audit.distance_deviation = 0.0015;
  audit.distance_deviation_sigma = 0.0005;
  return audit;
}

json JsonOf(const ScaleAudit& audit) {
  MetricsReport report;
  AddMetrics(audit, &report);
  return json::parse(Written([&](std::ostream& out) { WriteMetricsJson(report, out); }));
}

TEST(ScaleAuditReport, HasFiguresInPercentWithTheirSigmas) {
  const json report = JsonOf(FullAudit());
  EXPECT_NEAR(report["marker_scale_deviation_percent"].get<double>(), 0.01, 1e-12);
  EXPECT_NEAR(report["marker_scale_deviation_sigma_percent"].get<double>(), 0.02, 1e-12);
  EXPECT_NEAR(report["marker_scale_spread_percent"].get<double>(), 0.3, 1e-12);
  EXPECT_NEAR(report["x_over_y_percent"].get<double>(), 0.2, 1e-10);
  EXPECT_NEAR(report["x_over_y_sigma_percent"].get<double>(), 0.05, 1e-12);
  EXPECT_EQ(report["disagreeing_marker_ids"], json{9});
  EXPECT_EQ(report["print_spread_um"], 12.0);
  EXPECT_EQ(report["print_spread_sigma_um"], 2.0);
  EXPECT_FALSE(report.contains("image_spread_px"));
  EXPECT_FALSE(report.contains("apparent_inset_px"));
  EXPECT_EQ(report["spread_note"], "print only");
  EXPECT_NEAR(report["known_distance_deviation_percent"].get<double>(), 0.15, 1e-12);
}

TEST(ScaleAuditReport, HasATableOfEveryKind) {
  const json report = JsonOf(FullAudit());
  EXPECT_EQ(report["scale_histogram"][1]["num_markers"], 2);
  EXPECT_EQ(report["scale_histogram"][1]["to_percent"], 100.0);
  EXPECT_EQ(report["scale_markers"].size(), 2u);
  ASSERT_EQ(report["disagreeing_markers"].size(), 1u);
  EXPECT_EQ(report["disagreeing_markers"][0]["marker_id"], 9);
  EXPECT_EQ(report["disagreeing_markers"][0]["side_mm"], 50.0);
  EXPECT_EQ(report["disagreeing_markers"][0]["deviation_percent"], 100.0);
  EXPECT_NEAR(report["scale_parts"][0]["deviation_from_others_percent"].get<double>(), 0.4, 1e-12);
  EXPECT_FALSE(report["scale_parts"][1].contains("deviation_from_others_sigma_percent"));
  EXPECT_EQ(report["scale_sizes"][0]["layout_length_mm"], 50.0);
  const json& distance = report["known_distances"][0];
  EXPECT_EQ(distance["from"], "4");
  EXPECT_EQ(distance["to"], "9.2");
  EXPECT_EQ(distance["use"], "check");
  EXPECT_EQ(distance["measured_mm"], 2000.0);
  EXPECT_NEAR(distance["difference_mm"].get<double>(), 2.9, 1e-9);
  EXPECT_NEAR(distance["difference_in_sigmas"].get<double>(), 2.9, 1e-9);
  EXPECT_FALSE(distance.contains("distance_sigma_mm"));
  EXPECT_EQ(report["known_distances"][1]["use"], "scale");
  EXPECT_FALSE(report["known_distances"][1].contains("distance_mm"));
}

std::string ShortForm(const ScaleEstimate& scale, const ScaleAudit& audit) {
  return Written([&](std::ostream& out) { PrintScaleAudit(scale, audit, out); });
}

TEST(ScaleAuditReport, TheShortFormHasAtMostFourLines) {
  ScaleEstimate scale;
  scale.relative_sigma = 4e-4;
  scale.num_markers = 2;
  const std::string text = ShortForm(scale, FullAudit());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
  EXPECT_THAT(text, HasSubstr("scale_sigma: 0.0400 % (2 markers"));
  EXPECT_THAT(text,
              HasSubstr("scale_disagreeing_markers: 1 of 2; against the others: 9 by +99.98 %\n"));
  EXPECT_THAT(text, HasSubstr("scale_of_part_against_others: hull +0.400 +- 0.100 %"));
  EXPECT_THAT(text, HasSubstr("known_distances: 1 of 2 reconstructed, checks off by +0.150 +- "
                              "0.050 %, worst 4-9.2 +2.90 mm (+2.9 sigmas)\n"));
}

// All markers are 0.9 % off the layout; one of them is 3.1 sigmas off the others.
TEST(ScaleAuditReport, TheShortFormComparesAMarkerWithTheOthersAndNotWithTheLayout) {
  ScaleAudit audit = FullAudit();
  audit.deviation = -0.009;
  audit.markers[1].deviation = -0.0112;
  EXPECT_THAT(ShortForm({}, audit), HasSubstr("1 of 2; against the others: 9 by -0.22 %\n"));
  audit.parts_disagree = true;
  audit.markers[1].sigmas_off = -4;
  audit.markers[1].sigma = 4e-3;  // 5e-3 with the spread
  EXPECT_THAT(ShortForm({}, audit),
              HasSubstr("1 of 2; against those of their part: 9 by -1.98 %\n"));
}

TEST(ScaleAuditReport, ACheckBeyondThreeSigmasIsAWarning) {
  ScaleAudit audit = FullAudit();
  EXPECT_TRUE(ScaleWarnings(audit).empty());
  audit.distances[0].distance_m = 2.0152;
  ASSERT_EQ(ScaleWarnings(audit).size(), 1u);
  EXPECT_THAT(
      ScaleWarnings(audit)[0],
      HasSubstr(
          "from marker 4 to marker 9.2 was measured as 2 +- 0.001 m, but is 2.0152 m in the shape: "
          "off by +15.2 mm, 15.2 sigmas"));
  // The sigma of the shape counts, too.
  audit.distances[0].sigma_m = 0.008;
  EXPECT_TRUE(ScaleWarnings(audit).empty());
  // What took part in the adjustment is no check of it.
  audit.distances[0].sigma_m = 1e-4;
  EXPECT_EQ(ScaleWarnings(audit).size(), 1u);
  audit.distances[0].known.is_scale_bar = true;
  EXPECT_TRUE(ScaleWarnings(audit).empty());
}

// The shape of COLMAP's bundle adjuster has no sigmas, and its scale comes from the markers.
TEST(ScaleAuditReport, AScaleBarThatNoAdjustmentUsedIsACheckAndAWarning) {
  ScaleAudit audit = FullAudit();
  audit.distances[0].known = {4, 0, 9, 2, 2.412, 0.002, true};
  audit.distances[0].distance_m = 2.65;
  EXPECT_EQ(NumChecks(audit), 1);
  EXPECT_EQ(FailedChecks(audit).size(), 1u);
  const std::vector<std::string> warnings = ScaleWarnings(audit);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_THAT(warnings[0], HasSubstr("use: scale (4-9.2) are only compared"));
  EXPECT_THAT(warnings[0], HasSubstr("--backend markers or both"));
  EXPECT_THAT(warnings[1], HasSubstr("off by +238.0 mm"));
  audit.distances[0].sigma_m = 0.001;  // used, or left out with a warning of its own
  EXPECT_EQ(NumChecks(audit), 0);
  EXPECT_TRUE(ScaleWarnings(audit).empty());
}

TEST(ScaleAuditReport, TheShortFormNamesNoMoreMarkersThanFitALine) {
  ScaleAudit audit = FullAudit();
  for (int id = 100; id < 200; ++id) {
    audit.markers.push_back(audit.markers[1]);
    audit.markers.back().marker_id = id;
  }
  EXPECT_THAT(ShortForm({}, audit),
              HasSubstr("scale_disagreeing_markers: 101 of 102; against the others: 9 by"));
  EXPECT_THAT(ShortForm({}, audit), HasSubstr(", ...\n"));
  EXPECT_EQ(ShortForm({}, ScaleAudit()), "");
}

}  // namespace
}  // namespace velamap
