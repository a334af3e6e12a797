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

// A JSON text as the content of a script element: escapes `<`, which could end the element or begin
// a comment.
std::string EscapeForScript(const std::string& json);

}  // namespace velamap
