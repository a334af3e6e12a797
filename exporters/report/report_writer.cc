#include "exporters/report/report_writer.h"

#include "exporters/report/html_page.h"
#include "exporters/report/report_assets.h"

namespace velamap {

void WriteReport(const ReportInput& input, std::ostream& out) {
  WriteScriptPage(kReportPage, kReportScript, input.title, ReportJson(input), out);
}

}  // namespace velamap
