// Effects of lens, exposure and sensor on a picture (CV_32FC3, linear light, 255 for white). All
// kernels are symmetric, so they do not displace anything.

#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace velamap {

// Blurs the picture as if it moved by `length_px` at constant speed during the exposure, whose
// middle is the time of the truth. The angle of the motion is from the image's x towards y.
void MotionBlur(double length_px, double angle_rad, cv::Mat* image);

// Gaussian blur.
void LensBlur(double sigma_px, cv::Mat* image);

// Adds the same Gaussian noise to all three channels, because a video keeps only the luma of the
// sensor's noise. Its variance is sigma^2 (read noise) plus shot_sigma^2 * light / 255 (shot
// noise), with the light of the middle channel.
void AddNoise(double sigma, double shot_sigma, std::uint64_t seed, cv::Mat* image);

}  // namespace velamap
