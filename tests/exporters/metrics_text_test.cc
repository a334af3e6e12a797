#include "exporters/metrics_text.h"

#include <regex>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

using testing::HasSubstr;
using testing::Not;

ShapeMetrics ExampleMetrics() {
  ShapeMetrics metrics;
  metrics.num_markers = 1234;
  metrics.area_error_mm2 = ComputeStatistics({1, 2, 6});
  metrics.area_error_percent = ComputeStatistics({0.5, 1.5});
  metrics.side_error_mm = ComputeStatistics({0.25});
  metrics.num_layout_markers = 1236;
  metrics.reconstruction_ratio = 0.5;
  metrics.missing_marker_ids = {7, 1100};
  return metrics;
}

template <typename Metrics>
std::string Print(const Metrics& metrics) {
  return Written([&](std::ostream& out) { PrintMetrics(metrics, out); });
}

TEST(MetricsText, HoldsEveryStatistic) {
  EXPECT_THAT(Print(ExampleMetrics()), HasSubstr("num_markers: 1234\n"
                                                 "num_layout_markers: 1236\n"
                                                 "reconstruction_ratio: 0.5\n"
                                                 "missing_marker_ids: 7 1100\n"
                                                 "area_error_mm2_count: 3\n"
                                                 "area_error_mm2_mean: 3\n"
                                                 "area_error_mm2_std: 2.64575\n"
                                                 "area_error_mm2_median: 2\n"
                                                 "area_error_mm2_min: 1\n"
                                                 "area_error_mm2_max: 6\n"
                                                 "area_error_mm2_rms: 3.69685\n"
                                                 "area_error_percent_count: 2\n"));
  EXPECT_THAT(Print(ExampleMetrics()), HasSubstr("side_error_mm_median: 0.25\n"));
}

TEST(MetricsText, EveryLineIsAKeyAndAValueInAnyLocale) {
  const std::string expected = Print(ExampleMetrics());
  const CommaLocale locale;
  EXPECT_EQ(Print(ExampleMetrics()), expected);
  std::istringstream lines(expected);
  std::string line;
  while (std::getline(lines, line)) {
    EXPECT_TRUE(std::regex_match(line, std::regex("[a-z0-9_]+: [-+.e0-9 ]+"))) << line;
  }
}

TEST(MetricsText, WhatIsNotKnownIsNotPrinted) {
  const std::string text = Print(ShapeMetrics());
  EXPECT_THAT(text, HasSubstr("num_markers: 0\n"));
  EXPECT_THAT(text, HasSubstr("area_error_mm2_count: 0\n"));
  EXPECT_THAT(text, Not(HasSubstr("mean")));
  EXPECT_THAT(text, Not(HasSubstr("layout")));
  EXPECT_THAT(text, Not(HasSubstr("missing")));
}

TEST(MetricsText, NoMissingMarkersIsSaid) {
  ShapeMetrics metrics = ExampleMetrics();
  metrics.missing_marker_ids.clear();
  EXPECT_THAT(Print(metrics), HasSubstr("missing_marker_ids: none\n"));
}

TEST(MetricsText, ComparisonIsInMillimetres) {
  ShapeComparison comparison;
  comparison.num_points = 2;
  comparison.distance_m = ComputeStatistics({0.001, 0.003});
  comparison.scale = 1.0125;
  comparison.distance_after_scaling_m = ComputeStatistics({0.0005, 0.0005});
  const std::string text = Print(comparison);
  EXPECT_THAT(text, HasSubstr("num_points: 2\ndistance_mm_count: 2\ndistance_mm_mean: 2\n"));
  EXPECT_THAT(text, HasSubstr("distance_mm_std: 1.41421\n"));
  EXPECT_THAT(text, HasSubstr("distance_mm_max: 3\n"));
  EXPECT_THAT(text, HasSubstr("scale: 1.0125\nscale_error_percent: 1.25\n"));
  EXPECT_THAT(text, HasSubstr("distance_after_scaling_mm_rms: 0.5\n"));
}

}  // namespace
}  // namespace velamap
