#include "exporters/formats/metrics_report.h"

#include <map>
#include <regex>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "importer/text/csv.h"
#include "tests/exporters/comma_locale.h"
#include "tests/exporters/example_model.h"

namespace velamap {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr double kAwkward = 1234567.1 / 3.0;  // needs all its digits
const std::string kOddName = "a \"quoted\", name.png";

MetricsReport ExampleReport() {
  MetricsReport report;
  report.metrics = {{"num_markers", 1234},
                    {"ratio", kAwkward},
                    {"image_name", kOddName},
                    {"missing_marker_ids", std::vector<int>{7, 1100}},
                    {"error_mm", ComputeStatistics({1, 2, 6, 1e-17})},
                    {"nothing_mm", Statistics()}};
  report.tables = {{"images",
                    true,
                    {{{"name", std::string("a")}, {"n", 3}},
                     {{"name", kOddName}, {"px", ComputeStatistics({0.5, 1.5})}}}},
                   {"markers", false, {{{"marker_id", 17}}}}};
  return report;
}

std::string Text(const MetricsReport& report) {
  return Written([&](std::ostream& out) { PrintMetrics(report, out); });
}
std::string Csv(const MetricsReport& report) {
  return Written([&](std::ostream& out) { WriteMetricsCsv(report, out); });
}
std::string Json(const MetricsReport& report) {
  return Written([&](std::ostream& out) { WriteMetricsJson(report, out); });
}

// Values of the CSV by table,row,key.
std::map<std::string, std::string> CsvFigures(const MetricsReport& report) {
  std::istringstream in(Csv(report));
  std::map<std::string, std::string> figures;
  for (const CsvRecord& record : ReadCsv(in, "metrics.csv")) {
    EXPECT_EQ(record.fields.size(), 4u);
    const auto& f = record.fields;
    EXPECT_TRUE(figures.emplace(f[0] + "," + f[1] + "," + f[2], f[3]).second) << f[2];
  }
  EXPECT_EQ(figures.erase("table,row,key"), 1u);
  return figures;
}

void Flatten(const std::string& prefix, const json& object, std::map<std::string, json>* figures) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_array() && !value.empty() && value[0].is_object()) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        Flatten(key + "," + std::to_string(i) + ",", value[i], figures);
      }
    } else {
      (*figures)[prefix + key] = value;
    }
  }
}

TEST(MetricsReport, CsvAndJsonHoldTheSameKeysAndTheSameValuesToTheLastBit) {
  const auto csv = CsvFigures(ExampleReport());
  std::map<std::string, json> figures;
  Flatten(",,", json::parse(Json(ExampleReport())), &figures);
  ASSERT_EQ(csv.size(), figures.size());
  for (const auto& [key, value] : figures) {
    ASSERT_EQ(csv.count(key), 1u) << key;
    if (value.is_number()) {
      EXPECT_EQ(std::stod(csv.at(key)), value.get<double>()) << key;
    } else if (value.is_string()) {
      EXPECT_EQ(csv.at(key), value.get<std::string>()) << key;
    }
  }
  EXPECT_EQ(figures.at(",,ratio").get<double>(), kAwkward);
  EXPECT_EQ(figures.at(",,error_mm_min").get<double>(), 1e-17);
  EXPECT_EQ(figures.at(",,image_name"), kOddName);
  EXPECT_EQ(figures.at(",,missing_marker_ids"), (json{7, 1100}));
  EXPECT_EQ(csv.at(",,missing_marker_ids"), "7 1100");
  EXPECT_EQ(figures.at("images,1,px_max"), 1.5);
  EXPECT_EQ(figures.at("markers,0,marker_id"), 17);
}

TEST(MetricsReport, TextHasEveryKeyThatIsInNoTable) {
  const std::string text = Text(ExampleReport());
  for (const auto& [key, value] : CsvFigures(ExampleReport())) {
    if (key.substr(0, 2) != ",,") continue;
    EXPECT_THAT(text, HasSubstr(key.substr(2) + ": "));
  }
  EXPECT_THAT(text, HasSubstr("num_markers: 1234\nratio: 411522\n"));
  EXPECT_THAT(text, HasSubstr("missing_marker_ids: 7 1100\n"));
  EXPECT_THAT(text, HasSubstr("error_mm_count: 4\nerror_mm_mean: 2.25\nerror_mm_std: 2.62996\n"
                              "error_mm_median: 1.5\nerror_mm_min: 1e-17\nerror_mm_max: 6\n"
                              "error_mm_rms: 3.20156\n"));
  EXPECT_THAT(text, HasSubstr("images: name a, n 3\n"));
  EXPECT_THAT(text, HasSubstr("px mean 1 std 0.707107 median 1 min 0.5 max 1.5\n"));
  EXPECT_THAT(text, Not(HasSubstr("marker_id 17")));  // a long table
}

TEST(MetricsReport, AStatisticWithoutValuesHasACountOnly) {
  EXPECT_THAT(Text(ExampleReport()), HasSubstr("nothing_mm_count: 0\n"));
  for (const std::string& form :
       {Text(ExampleReport()), Csv(ExampleReport()), Json(ExampleReport())}) {
    EXPECT_THAT(form, Not(HasSubstr("nothing_mm_mean")));
  }
}

TEST(MetricsReport, LocaleChangesNoByte) {
  const std::string expected = Text(ExampleReport()) + Csv(ExampleReport()) + Json(ExampleReport());
  const CommaLocale locale;
  EXPECT_EQ(Text(ExampleReport()) + Csv(ExampleReport()) + Json(ExampleReport()), expected);
}

TEST(MetricsReport, EveryLineOfTheTextIsAKeyAndAValue) {
  MetricsReport report = ExampleReport();
  report.metrics[2].value = std::string("two\nlines: 7");
  report.metrics.push_back({"missing", std::vector<int>()});
  const std::string text = Text(report);
  EXPECT_THAT(text, HasSubstr("image_name: two lines: 7\n"));
  EXPECT_THAT(text, HasSubstr("missing: none\n"));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_TRUE(std::regex_match(line, std::regex("[a-z0-9_]+: [^ ].*"))) << line;
  }
}

TEST(MetricsReport, WhatJsonCannotHoldDoesNotBreakIt) {
  MetricsReport report;
  report.metrics = {{"x_mm", std::numeric_limits<double>::infinity()},
                    {"name", std::string("gr\xFCn.png")}};  // Latin-1
  const json parsed = json::parse(Json(report));
  EXPECT_TRUE(parsed.at("x_mm").is_null());
  EXPECT_THAT(parsed.at("name").get<std::string>(), HasSubstr("n.png"));
}

}  // namespace
}  // namespace velamap
