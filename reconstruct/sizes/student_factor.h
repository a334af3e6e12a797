// The factor that widens an interval whose sigma comes from few values.

#pragma once

namespace velamap {

// Half the width of the interval that holds 68 % of Student's t: 1.84 for one degree of freedom, 1
// for many.
double StudentFactor(double degrees_of_freedom);

}  // namespace velamap
