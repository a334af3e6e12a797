// Pages of HTML that are made from a text with placeholders.

#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace velamap {

// Writes `page` with `part(NAME)` in the place of every {{NAME}}. What is inserted is not searched,
// because it can contain braces.
void WriteHtmlPage(std::string_view page,
                   const std::function<std::string(std::string_view name)>& part,
                   std::ostream& out);

// Writes a page with scripts: TITLE and DATA stand for `title` and the JSON text `data`, SCRIPT for
// `script`, and VIEW, STYLE, THREE, CHART and LICENCES for what report_assets.h says of them.
void WriteScriptPage(std::string_view page, std::string_view script, const std::string& title,
                     const std::string& data, std::ostream& out);

// A JSON text as the content of a script element: escapes `<`, which could end the element or begin
// a comment.
std::string EscapeForScript(const std::string& json);

}  // namespace velamap
