// Effects of lens, exposure and sensor on a picture (CV_32F, linear light, 255 for white). All
// kernels are symmetric, so they do not displace anything.

#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "importer/camera/camera.h"

namespace velamap {

// Lenses and motion blur the light before the sensor takes its means over pixels. A picture is
// therefore drawn and blurred at this many times the sensor's resolution along both sides. On the
// sensor's pixels, a kernel of less than a pixel would spread light in steps of a pixel, as no lens
// does, and the estimate of the image formation would take that for sharpening and a tone curve.
constexpr int kFinePerSensorPx = 2;

// The camera that takes the fine picture.
Camera FineCamera(const Camera& camera);

// Blurs a fine picture as if it moved by `length_px` (of the sensor) at constant speed during the
// exposure, whose middle is the time of the truth. The angle of the motion is from the image's x
// towards y.
void MotionBlur(double length_px, double angle_rad, cv::Mat* fine);

// Gaussian blur of a fine picture; its sigma is in px of the sensor.
void LensBlur(double sigma_px, cv::Mat* fine);

// Blurs a fine picture by a lens out of focus, through which a point is an even disc; its radius is
// in px of the sensor.
void DefocusBlur(double radius_px, cv::Mat* fine);

// The means of a fine picture over the sensor's pixels.
cv::Mat OnSensor(const cv::Mat& fine);

// Scatters a share of the light over a Gaussian of a few pixels of the sensor, as aberrations and
// plastic covers do.
void Halo(double share, double sigma_px, cv::Mat* image);

// Adds the same Gaussian noise to all three channels of a picture, because a video keeps only the
// luma of the sensor's noise. Its variance is sigma^2 (read noise) plus shot_sigma^2 * light / 255
// (shot noise), with the light of the middle channel.
void AddNoise(double sigma, double shot_sigma, std::uint64_t seed, cv::Mat* image);

}  // namespace velamap
