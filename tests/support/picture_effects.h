// What lens, exposure and sensor do to a picture (CV_32FC3, grey levels). Nothing moves: every
// kernel is symmetric.

#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace velamap {

// The picture moved by `length_px` during the exposure, evenly, half of it before the moment that
// the truth is about; the angle is from the image's x towards y.
void MotionBlur(double length_px, double angle_rad, cv::Mat* image);

// Gaussian.
void LensBlur(double sigma_px, cv::Mat* image);

// Gaussian, the same on all three channels: what a video keeps of a sensor's noise is its
// brightness.
void AddNoise(double sigma, std::uint64_t seed, cv::Mat* image);

}  // namespace velamap
