// ImageFormationParameters (formation_estimate.h), ready for the pixels of many markers.

#pragma once

#include <array>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "importer/lanes/float_lanes.h"
#include "importer/pattern/formation_estimate.h"

namespace velamap {

// A tone curve as a table over the square root of light, where all curves are smooth.
class ToneCurve {
 public:
  explicit ToneCurve(const ImageFormationParameters& parameters);

  bool IsLinear() const { return is_linear_; }

  // Grey values of a group of lights, and their slope. The curve continues as a line beyond the
  // ends of the table.
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
    const Floats by_light = step * (0.5f * kScale) / root;
    *slope = sign_ * by_light;
    return offset_ + sign_ * (low + rest * step + (light - root * root) * by_light);
  }

  double Encode(double light) const;
  double Decode(double gray) const;  // the inverse

  void Decode(cv::Mat* values) const;  // each value of a matrix of CV_32F

 private:
  static constexpr int kSteps = 512;
  static constexpr int kStepsPerGray = 8;
  static constexpr float kMaxRoot = 20.0f;  // the root of the largest light, 400
  static constexpr double kMinLight = 0.05;

  bool is_linear_;
  float sign_, offset_;                         // of inverted images -1 and 255, else 1 and 0
  std::array<float, kSteps + 1> gray_of_root_;  // as recorded
  std::array<int, 256> first_above_gray_;       // idx in `gray_of_root_`, where Decode() begins
  std::array<float, 255 * kStepsPerGray + 1> light_of_gray_;
};

// The parameters, ready for many markers.
class ImageFormation {
 public:
  explicit ImageFormation(const ImageFormationParameters& parameters = {});

  const ImageFormationParameters& parameters() const { return parameters_; }
  const ToneCurve& tone() const { return tone_; }
  // Kernel that undoes the sharpening; empty for none.
  const cv::Mat& unsharpening() const { return unsharpening_; }

 private:
  ImageFormationParameters parameters_;
  ToneCurve tone_;
  cv::Mat unsharpening_;
};

// A part of an image in grey values without the sharpening.
struct GrayPatch {
  cv::Mat values;       // CV_32F
  cv::Point origin_px;  // of its first pixel in the image
  // CV_32F: the light that reaches each pixel by the halo; empty: none.
  cv::Mat scattered_light;
  // 8 bit: not zero where a pixel does not count, because it is clipped (clipped_pixels.h) or shows
  // something in front of the marker. Empty: all count.
  cv::Mat is_left_out;
};

// How far beyond a patch the pixels of the image act on it.
int PatchReachPx(const ImageFormation& formation);

// Cuts the part of the image (8 bit or CV_32F) within `box`, which may reach beyond the image.
GrayPatch CutPatch(const cv::Mat& gray, const cv::Rect& box, const ImageFormation& formation);

// Sharpens grey values (CV_32F); `border` is one of OpenCV's kinds.
void Sharpen(const ImageFormationParameters& parameters, int border, cv::Mat* values);

// Bilinear value at a place in OpenCV's pixel frame of the image; places outside the patch take the
// nearest value inside.
double InterpolatePatch(const GrayPatch& patch, const Eigen::Vector2d& x_px);

// Light at such a place without the halo.
double LightAt(const GrayPatch& patch, const ImageFormation& formation,
               const Eigen::Vector2d& x_px);

}  // namespace velamap
