// Formatted text on a stream. It is formatted inside the fmt library, because fmt::print for
// streams would compile fmt's formatting once more in every file.

#pragma once

#include <ostream>
#include <utility>

#include <fmt/format.h>

namespace velamap {

// Writes a text in fmt's syntax.
template <typename... Args>
void WriteFormatted(std::ostream& out, fmt::format_string<Args...> format, Args&&... args) {
  out << fmt::format(format, std::forward<Args>(args)...);
}

}  // namespace velamap
