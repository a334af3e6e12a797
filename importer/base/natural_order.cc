#include "importer/base/natural_order.h"

#include <cstddef>
#include <string_view>

namespace velamap {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Returns the run of digits at `begin` without leading zeros, and moves `begin` behind the run.
std::string_view TakeNumber(const std::string& text, std::size_t* begin) {
  std::size_t end = *begin;
  while (end < text.size() && IsDigit(text[end])) ++end;
  std::size_t first = *begin;
  while (first + 1 < end && text[first] == '0') ++first;
  *begin = end;
  return std::string_view(text).substr(first, end - first);
}

}  // namespace

bool NaturalLess(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::string_view number_a = TakeNumber(a, &i), number_b = TakeNumber(b, &j);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a[i] != b[j]) {
        return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      }
      ++i;
      ++j;
    }
  }
  const bool a_ended = i == a.size(), b_ended = j == b.size();
  return a_ended && b_ended ? a < b : a_ended;
}

}  // namespace velamap
