// The normal distribution and its density, tabulated: blurred edges ask for them thousands of times
// a marker. Linear interpolation, good to 1e-5.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace velamap {

class NormalTable {
 public:
  struct Value {
    double distribution, density;
  };

  NormalTable() {
    for (int i = 0; i <= kSize; ++i) {
      const double z = kMinZ + i * kStep;
      entries_[static_cast<std::size_t>(i)] = {0.5 * std::erfc(-z * 0.70710678118654752),
                                               0.39894228040143268 * std::exp(-0.5 * z * z)};
    }
  }

  Value At(double z) const {
    const double place = std::clamp((z - kMinZ) / kStep, 0.0, kSize - 1e-9);
    const int index = static_cast<int>(place);
    const double fraction = place - index;
    const Value& a = entries_[static_cast<std::size_t>(index)];
    const Value& b = entries_[static_cast<std::size_t>(index) + 1];
    return {a.distribution + fraction * (b.distribution - a.distribution),
            a.density + fraction * (b.density - a.density)};
  }

 private:
  static constexpr double kMinZ = -6.0;
  static constexpr double kStep = 1.0 / 64;
  static constexpr int kSize = 768;

  std::array<Value, kSize + 1> entries_;
};

// One for all; a static of a function would be guarded at every look-up.
inline const NormalTable kNormalTable;

}  // namespace velamap
