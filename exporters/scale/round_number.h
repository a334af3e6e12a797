// Round numbers for the bins of histograms and for magnifications.

#pragma once

#include <cmath>

namespace velamap {

// The smallest of 1, 2 or 5 times a power of ten that is at least `x`, which is positive. The
// tolerance keeps a quotient such as 0.3 / 3 from becoming 0.2.
inline double RoundUp(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= x * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

// The largest of 1, 2 or 5 times a power of ten that is at most `x`, which is positive.
inline double RoundDown(double x) { return 1.0 / RoundUp(1.0 / x); }

}  // namespace velamap
