// Effects of lens, exposure and sensor on a picture (CV_32FC3, linear light, 255 at white). All
// kernels are symmetric, so nothing moves.

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
// noise. Its variance is sigma^2 of the sensor's reading plus shot_sigma^2 at full light (255), in
// proportion to the light of the middle channel.
void AddNoise(double sigma, double shot_sigma, std::uint64_t seed, cv::Mat* image);

}  // namespace velamap
