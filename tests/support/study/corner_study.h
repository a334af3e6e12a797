// Measures the accuracy of the corners of rendered markers, and compares it with cv::cornerSubPix
// and with the Cramer-Rao bound of the fitted model.

#pragma once

#include <cstdint>

namespace velamap {

struct CornerCase {
  double side_px = 25.0;  // of the marker before it is tilted
  double blur_px = 0.7;   // sigma of the lens blur
  double noise = 2.0;     // standard deviation, grey levels
  double min_tilt_deg = 0.0, max_tilt_deg = 50.0;
  int jpeg_quality = 0;   // 0: not compressed
  double bend_deg = 0.0;  // angle of the arc of a marker on a cylinder; 0: flat
  int min_markers = 120;
  std::uint32_t seed = 1;
};

// Means over all markers of a case. Standard deviations are per coordinate and leave out the common
// inset of the corners, which appears as a bias of the side.
struct CornerAccuracy {
  int num_markers = 0, num_failed = 0;
  double side_bias_px = 0.0;        // mean error of the side length
  double side_bias_sigma_px = 0.0;  // 1 sigma of this mean
  double std_px = 0.0;
  double subpix_side_bias_px = 0.0, subpix_std_px = 0.0;
  // Cramer-Rao bound: the smallest standard deviation of an unbiased estimate from all pixels of
  // the marker. It assumes white noise, a known shape of the blur and a flat marker.
  double bound_px = 0.0;
  double error_over_sigma = 0.0;  // RMS; 1 if the sigmas are right
};

CornerAccuracy MeasureCorners(const CornerCase& parameters);

}  // namespace velamap
