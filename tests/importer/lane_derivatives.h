// Derivatives that the models of importer/pattern and importer/refine work out in lanes.

#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "importer/lanes/float_lanes.h"

namespace velamap {

// Whether `jacobian`, a group of observations, agrees with what `value` changes by.
template <typename Vector, typename Jacobian, typename Value>
void ExpectDerivatives(const Vector& parameters, const Vector& steps, const Jacobian& jacobian,
                       const Value& value, double relative_tolerance, double tolerance) {
  for (int i = 0; i < parameters.size(); ++i) {
    Vector above = parameters, below = parameters;
    above[i] += steps[i];
    below[i] -= steps[i];
    const Floats difference = (value(above) - value(below)) / static_cast<float>(2 * steps[i]);
    for (int lane = 0; lane < kLanes; ++lane) {
      EXPECT_NEAR(jacobian[static_cast<std::size_t>(i)][lane], difference[lane],
                  relative_tolerance * std::abs(difference[lane]) + tolerance)
          << "parameter " << i << ", lane " << lane;
    }
  }
}

}  // namespace velamap
