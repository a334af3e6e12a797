#include "reconstruct/sizes/student_factor.h"

#include <boost/math/distributions/students_t.hpp>

namespace velamap {

double StudentFactor(double degrees_of_freedom) {
  constexpr double kBelowOneSigma = 0.841344746;
  const boost::math::students_t distribution(degrees_of_freedom);
  return boost::math::quantile(distribution, kBelowOneSigma);
}

}  // namespace velamap
