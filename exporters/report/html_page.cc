#include "exporters/report/html_page.h"

#include <ostream>

#include "importer/base/error.h"

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
