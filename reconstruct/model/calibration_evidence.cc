#include "reconstruct/model/calibration_evidence.h"

#include <cmath>

namespace velamap {

double SigmasAgainst(const CalibrationEvidence& evidence) {
  if (evidence.num_changes == 0) return 0.0;
  const double degrees = evidence.num_changes, spread = 2.0 / (9.0 * degrees);
  return (std::cbrt(evidence.chi_squared / degrees) - (1.0 - spread)) / std::sqrt(spread);
}

bool IsContradicted(const CalibrationEvidence& evidence) {
  return SigmasAgainst(evidence) > kMaxCalibrationSigmas &&
         evidence.systematic_px > kMaxSystematic_px;
}

}  // namespace velamap
