// The evidence that the residuals of an adjustment give for or against its fixed calibration.

#pragma once

namespace velamap {

// Zero for a calibration that was not tested.
struct CalibrationEvidence {
  // Number of independent changes of the calibration that the images can tell from another shape
  // or pose.
  int num_changes = 0;
  // Decrease of the sum of squared residuals by these changes: chi-squared with num_changes degrees
  // of freedom for a right calibration.
  double chi_squared = 0.0;
  // Shares of chi_squared that a change of the focal length alone, or of the distortion alone,
  // explains.
  double focal_share = 0.0, distortion_share = 0.0;
  // RMS over the corners of the part of the residuals that the changes explain, px.
  double systematic_px = 0.0;
  // Relative change of the focal length, with the others free, and its 1 sigma. Linearized, so that
  // large values are orders of magnitude.
  double focal_change = 0.0, focal_sigma = 0.0;
  // Linearized movement of the shape by the changes: RMS over the points after a rigid alignment,
  // m; the same divided by the 1 sigma of the adjustment; and the change of the scale alone, as a
  // fraction.
  double shape_change_m = 0.0, shape_change_in_sigmas = 0.0, scale_change = 0.0;
};

// The chi-squared as a value of the standard normal distribution (Wilson and Hilferty, 1931): by
// how many sigmas the residuals contradict the calibration. 0 if nothing was tested.
double SigmasAgainst(const CalibrationEvidence& evidence);

inline constexpr double kMaxCalibrationSigmas = 3.0, kMaxSystematic_px = 0.02;

// Whether the residuals contradict the calibration: beyond chance, and by more than the lens
// residue that the sigma of every corner contains
// (MarkerAdjustmentOptions::corner_sigma_floor_px).
bool IsContradicted(const CalibrationEvidence& evidence);

}  // namespace velamap
