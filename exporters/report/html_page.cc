#include "exporters/report/html_page.h"

#include <ostream>
#include <stdexcept>

#include "exporters/report/report_assets.h"
#include "importer/base/error.h"
#include "importer/text/markup.h"

namespace velamap {

void WriteHtmlPage(std::string_view page,
                   const std::function<std::string(std::string_view name)>& part,
                   std::ostream& out) {
  for (std::size_t begin; (begin = page.find("{{")) != std::string_view::npos;) {
    const std::size_t end = page.find("}}", begin);
    VELAMAP_CHECK(end != std::string_view::npos);
    out << page.substr(0, begin) << part(page.substr(begin + 2, end - begin - 2));
    page.remove_prefix(end + 2);
  }
  out << page;
}

void WriteScriptPage(std::string_view page, std::string_view script, const std::string& title,
                     const std::string& data, std::ostream& out) {
  const auto part = [&](std::string_view name) -> std::string {
    if (name == "TITLE") return EscapeForMarkup(title);
    if (name == "DATA") return data;
    if (name == "SCRIPT") return std::string(script);
    if (name == "VIEW") return std::string(kReportView);
    if (name == "STYLE") return std::string(kReportStyle);
    if (name == "THREE") return std::string(kReportThree);
    if (name == "CHART") return std::string(kReportChart);
    if (name == "LICENCES") return EscapeForMarkup(kReportLicences);
    throw std::logic_error("the page names an unknown part: " + std::string(name));
  };
  WriteHtmlPage(page, part, out);
}

std::string EscapeForScript(const std::string& json) {
  std::string escaped;
  escaped.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace velamap
