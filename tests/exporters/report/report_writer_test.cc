#include "exporters/report/report_writer.h"

#include <sstream>

#include <gmock/gmock.h>

#include "tests/exporters/report/report_example.h"

namespace velamap {
namespace {

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

TEST(ReportWriter, SameInputSameBytes) {
  const ReportExample example = MakeReportExample(2, 3);
  EXPECT_EQ(Page(example.Input()), Page(example.Input()));
}

}  // namespace
}  // namespace velamap
