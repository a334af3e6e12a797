#include "exporters/report/report_writer.h"

#include <stdexcept>
#include <string>
#include <string_view>

#include "exporters/report/html_page.h"
#include "exporters/report/report_assets.h"
#include "importer/text/markup.h"

namespace velamap {
namespace {

std::string_view Asset(std::string_view name) {
  if (name == "VIEW") return kReportView;
  if (name == "STYLE") return kReportStyle;
  if (name == "SCRIPT") return kReportScript;
  if (name == "THREE") return kReportThree;
  if (name == "CHART") return kReportChart;
  throw std::logic_error("the report's page names an unknown part: " + std::string(name));
}

}  // namespace

void WriteReport(const ReportInput& input, std::ostream& out) {
  WriteHtmlPage(
      kReportPage,
      [&](std::string_view name) -> std::string {
        if (name == "TITLE") return EscapeForMarkup(input.title);
        if (name == "DATA") return ReportJson(input);
        if (name == "LICENCES") return EscapeForMarkup(kReportLicences);
        return std::string(Asset(name));
      },
      out);
}

}  // namespace velamap
