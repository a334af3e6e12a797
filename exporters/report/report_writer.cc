#include "exporters/report/report_writer.h"

#include <ostream>
#include <string>

#include "exporters/report/report_assets.h"
#include "importer/base/error.h"

namespace velamap {
namespace {

std::string EscapeForHtml(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string_view Asset(std::string_view name) {
  if (name == "STYLE") return kReportStyle;
  if (name == "SCRIPT") return kReportScript;
  if (name == "THREE") return kReportThree;
  if (name == "CHART") return kReportChart;
  throw std::logic_error("the report's page names an unknown part: " + std::string(name));
}

}  // namespace

void WriteReport(const ReportInput& input, std::ostream& out) {
  const std::string json = ReportJson(input);
  std::string_view rest = kReportPage;
  // Searches the page only, because the inserted data can contain braces.
  for (std::size_t begin; (begin = rest.find("{{")) != std::string_view::npos;) {
    const std::size_t end = rest.find("}}", begin);
    VELAMAP_CHECK(end != std::string_view::npos);
    out << rest.substr(0, begin);
    const std::string_view name = rest.substr(begin + 2, end - begin - 2);
    if (name == "TITLE") {
      out << EscapeForHtml(input.title);
    } else if (name == "DATA") {
      out << json;
    } else if (name == "LICENCES") {
      out << EscapeForHtml(kReportLicences);
    } else {
      out << Asset(name);
    }
    rest.remove_prefix(end + 2);
  }
  out << rest;
}

}  // namespace velamap
