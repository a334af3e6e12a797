#include "exporters/report/report_writer.h"

#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/exporters/report/report_example.h"

namespace velamap {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

std::string Page(const ReportInput& input) {
  std::ostringstream out;
  WriteReport(input, out);
  return out.str();
}

TEST(ReportWriter, TheDataCanBeReadBackFromThePage) {
  const ReportExample example = MakeReportExample(2, 3);
  ReportInput input = example.Input();
  input.title = "{{SCRIPT}} & <b>";
  const std::string page = Page(input);
  EXPECT_THAT(page, HasSubstr("<h1>{{SCRIPT}} &amp; &lt;b&gt;</h1>"));
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t first = page.find(begin) + begin.size();
  const std::string data = page.substr(first, page.find("</script>", first) - first);
  EXPECT_EQ(data, ReportJson(input));
}

TEST(ReportWriter, NothingIsLeftOutOrLoadedFromElsewhere) {
  const ReportExample example = MakeReportExample(2, 3);
  const std::string page = Page(example.Input());
  EXPECT_THAT(page, Not(HasSubstr("{{TITLE}}")));
  EXPECT_THAT(page, Not(HasSubstr("{{THREE}}")));
  EXPECT_THAT(page, HasSubstr("OrbitControls"));
  EXPECT_THAT(page, HasSubstr("Chart.js v3"));
  EXPECT_THAT(page, HasSubstr("Permission is hereby granted"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr("<script src")));
  EXPECT_THAT(page, Not(HasSubstr("<link rel=\"stylesheet\"")));
  EXPECT_THAT(page, HasSubstr("</html>"));
}

TEST(ReportWriter, TheAuditIsThatOfTheMetrics) {
  const ReportExample example = MakeReportExample(2, 4);
  ScaleAudit audit = AuditScale(example.shape, example.layout, &example.model, nullptr);
  MarkerScale off;
  off.marker_id = 1234;
  off.length_m = 0.1;
  off.sigmas_off = 9.87654321;
  audit.markers.push_back(off);
  ReportInput input = example.Input();
  EXPECT_FALSE(json::parse(ReportJson(input)).contains("scale_audit"));
  input.audit = &audit;
  std::multimap<std::string, json> lines;
  const json data = json::parse(ReportJson(input));
  for (const json& line : data.at("scale_audit")) {
    lines.emplace(line.at(0), line.at(1));
  }
  EXPECT_EQ(lines.count("num_disagreeing_markers"), 1u);
  EXPECT_EQ(lines.count("x_over_y_percent"), 1u);
  EXPECT_EQ(lines.count("scale_histogram"), 0u);
  EXPECT_EQ(lines.count("scale_markers"), 0u);
  EXPECT_EQ(lines.count("known_distances"), 0u);  // without rows
  // Values are as in the files: rows are lists of key and value, and ids are integers.
  EXPECT_EQ(lines.find("disagreeing_marker_ids")->second.back(), 1234);
  ASSERT_GT(lines.count("disagreeing_markers"), 0u);
  const json row = std::prev(lines.upper_bound("disagreeing_markers"))->second;
  EXPECT_EQ(row.front(), json::array({"marker_id", 1234}));
  EXPECT_EQ(row.back(), json::array({"sigmas_off", 9.87654321}));
}

TEST(ReportWriter, SameInputSameBytes) {
  const ReportExample example = MakeReportExample(2, 3);
  EXPECT_EQ(Page(example.Input()), Page(example.Input()));
}

}  // namespace
}  // namespace velamap
