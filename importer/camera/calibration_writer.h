// Writes a camera as the calibration file that ReadCalibration() reads.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "importer/camera/camera.h"

namespace velamap {

// A camera and how well it is known.
struct EstimatedCamera {
  Camera camera;
  std::vector<double> sigmas;  // 1 sigma of each parameter, in the camera's order
};

// 1 sigma of the focal length, in percent of it. A camera estimated from one clip is good enough
// for others up to kGoodFocalSigma_percent.
double FocalSigma_percent(const EstimatedCamera& found);
inline constexpr double kGoodFocalSigma_percent = 1.0;

// Why a camera estimated from one clip is not good enough for others; empty if it is. A distortion
// that folds over where the clip shows no marker does no harm to the shape, but to other clips.
std::string WhyNotForOtherClips(const EstimatedCamera& found);

// Whether the parameter was held at zero and not estimated, such as k4 to k6 of FULL_OPENCV.
bool IsHeldAtZero(const EstimatedCamera& estimate, std::size_t index);

// k1, k2, p1, ... of the distortion parameter at `index`.
const char* DistortionName(CameraModel model, std::size_t index);

// An OpenCV FileStorage file (YAML) with the keys of ReadCalibration(), and three more for people
// who read the file, which programs ignore: focal_length_sigma_px (x, y), principal_point_sigma_px
// (x, y) and distortion_sigma, in the order of distortion_coefficients. Models with one focal
// length or fewer coefficients become the OpenCV model that holds them exactly. `origin` says in
// one line where the camera comes from; it becomes a comment in the file.
std::string CalibrationText(const EstimatedCamera& estimate, const std::string& origin);

// Writes the text to `path`, whole or not at all. Throws InputError if that fails.
void WriteCalibration(const EstimatedCamera& estimate, const std::string& origin,
                      const std::string& path);

// `SIMPLE_RADIAL, focal length 901.3 +- 0.4 px, principal point (964.2 +- 0.5, 536.7 +- 0.6) px,
// distortion k1 -0.2451 +- 0.0012`, without distortion parameters that were held at 0. `sign`
// stands between a value and its sigma.
std::string DescribeCamera(const EstimatedCamera& estimate, std::string_view sign = "+-");

}  // namespace velamap
