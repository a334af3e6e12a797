// Numbers from text. They are decimal, do not depend on the locale, and fill the whole text: 010 is
// ten, and "1x" or " 1" are not numbers.

#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

namespace velamap {

// Returns whether `text` is one number that T holds; `value` is left alone otherwise.
// Floating-point types also accept inf and nan.
template <typename T>
bool ParseNumber(std::string_view text, T* value) {
  const char* const end = text.data() + text.size();
  T number{};
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end) return false;
  *value = number;
  return true;
}

// Parses numbers that are separated by commas, such as 12,15,40. Nothing unless all of them are
// numbers.
template <typename T>
std::optional<std::vector<T>> ParseNumberList(std::string_view text) {
  std::vector<T> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    if (!ParseNumber(text.substr(0, comma), &numbers.emplace_back())) return std::nullopt;
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace velamap
