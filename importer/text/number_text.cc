#include "importer/text/number_text.h"

#include <cmath>

#include <fmt/format.h>

namespace velamap {

std::string FixedText(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", value, digits);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  if (is_zero && text.front() == '-') text.erase(0, 1);
  return text;
}

std::string UncertainText(double value, const std::optional<double>& sigma, double factor,
                          int digits, std::string_view sign) {
  constexpr int kMaxDigits = 6;
  if (!sigma) return FixedText(factor * value, digits);
  const double shown = factor * *sigma;
  const double needed = shown > 0 ? std::ceil(std::log10(0.5 / shown)) : 0.0;
  if (needed > digits && needed <= kMaxDigits) digits = static_cast<int>(needed);
  return fmt::format("{} {} {}", FixedText(factor * value, digits), sign, FixedText(shown, digits));
}

}  // namespace velamap
