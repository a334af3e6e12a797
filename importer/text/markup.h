// Texts within HTML and SVG.

#pragma once

#include <string>
#include <string_view>

namespace velamap {

// The text as content or as a quoted attribute of HTML, XML or SVG. Control characters, which XML
// does not allow, become spaces; line breaks and tabs stay.
std::string EscapeForMarkup(std::string_view text);

}  // namespace velamap
