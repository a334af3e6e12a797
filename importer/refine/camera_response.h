// How a camera turns light into grey values, after its lens has blurred it: a tone curve, then
// sharpening.
//
//   gray = 255 S(v),  v = (light / 255)^(1 / gamma)
//   S(v) = v - s_amplitude sin(2 pi v)
//   sharpened = gray + sharpening (gray - G gray),  G a Gaussian of sharpening_radius_px
//
// A power is what sRGB and Rec. 709 are nearly; the sine is the S that cameras put on top. Light
// and grey values both run from 0 to 255.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/refine/float_lanes.h"

namespace velamap {

struct CameraResponse {
  double gamma = 1.0;
  double s_amplitude = 0.0;
  double sharpening = 0.0;
  double sharpening_radius_px = 1.0;
  bool is_inverted = false;  // of pictures whose grey values are 255 less those recorded
};

// The tone curve as a table over the square root of the light, in which all curves are smooth.
class ToneCurve {
 public:
  explicit ToneCurve(const CameraResponse& response);

  bool IsLinear() const { return is_linear_; }

  // Grey values of a group of lights, and their slope. Beyond the table's ends the curve goes on
  // straight.
  Floats Encode(Floats light, Floats* slope) const {
    if (is_linear_) {
      *slope = AllLanes(1.0);
      return light;
    }
    constexpr float kScale = static_cast<float>(kSteps) / kMaxRoot;
    const Floats root = Sqrt(Max(light, AllLanes(kMinLight)));
    const Floats place = Min(root * kScale, AllLanes(kSteps - 1));
    const Ints index = __builtin_convertvector(place, Ints);
    const Floats rest = root * kScale - __builtin_convertvector(index, Floats);
    Floats low, step;
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto i = static_cast<std::size_t>(index[lane]);
      low[lane] = gray_of_root_[i];
      step[lane] = gray_of_root_[i + 1] - gray_of_root_[i];
    }
    *slope = step * (0.5f * kScale) / root;
    return low + rest * step + (light - root * root) * *slope;
  }

  double Encode(double light) const;
  double Decode(double gray) const;

 private:
  static constexpr int kSteps = 512;
  static constexpr float kMaxRoot = 20.0f;  // of a light of 400
  static constexpr double kMinLight = 0.05;

  bool is_linear_;
  std::array<float, kSteps + 1> gray_of_root_;
};

// Grey values around a marker as the tone curve left them, without the sharpening.
struct GrayPatch {
  cv::Mat values;       // CV_32F
  cv::Point origin_px;  // of its first pixel in the image
};

// The inverse of the sharpening as a kernel; empty for none.
cv::Mat UnsharpeningKernel(const CameraResponse& response);

// Bilinear; places outside take the nearest value inside.
double InterpolatePatch(const GrayPatch& patch, const Eigen::Vector2d& x_px);

// The same patch as light, without the tone curve.
GrayPatch Linearized(GrayPatch patch, const ToneCurve& tone);

GrayPatch CutPatch(const cv::Mat& gray, const cv::Rect& box, const cv::Mat& unsharpening);

}  // namespace velamap
