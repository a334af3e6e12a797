// Effects of lens, exposure and sensor on a picture (CV_32FC3, grey levels). All kernels are
// symmetric, so nothing moves.

#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace velamap {

// The picture moves by `length_px` at constant speed during the exposure, half of it before the
// instant of the truth; the angle counts from the image's x towards y.
void MotionBlur(double length_px, double angle_rad, cv::Mat* image);

// Gaussian.
void LensBlur(double sigma_px, cv::Mat* image);

// Gaussian, the same on all three channels, because a video keeps only the brightness of a sensor's
// noise.
void AddNoise(double sigma, std::uint64_t seed, cv::Mat* image);

}  // namespace velamap
