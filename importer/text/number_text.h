// Numbers for people to read.

#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace velamap {

// The value with `digits` decimals. A negative value that rounds to zero becomes 0.0, not -0.0.
std::string FixedText(double value, int digits);

// "31.2 +- 1.1", or only the value if it has no sigma: both times `factor`, with `sign` between
// them. They have more decimals than `digits` where the sigma would be rounded to zero and six
// decimals are enough to show it.
std::string UncertainText(double value, const std::optional<double>& sigma, double factor,
                          int digits, std::string_view sign);

}  // namespace velamap
