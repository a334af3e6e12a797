// From light to grey values, as a camera does it after its lens: tone curve, then sharpening.
//
// Light and grey values run from 0 to 255; light is linear, and 255 is what saturates the sensor.
// The curves are those of cameras, on purpose not of the family that
// importer/pattern/image_formation.h fits.

#pragma once

#include <opencv2/core.hpp>

namespace velamap {

enum class ToneCurveKind {
  kLinear,  // grey values are light, as a machine-vision camera has it
  kSrgb,    // IEC 61966-2-1: a line below 0.3 % of light, a power 2.4 with an offset above
  kGamma,   // light^(1 / gamma)
  kSCurve,  // sRGB, then a filmic contrast with a toe and a longer shoulder
};

struct CameraResponse {
  ToneCurveKind tone_curve = ToneCurveKind::kLinear;
  double gamma = 2.2;  // of kGamma
  double s_curve =
      0.0;  // of kSCurve: by how much it moves the encoded values at most, part of white
  double sharpening = 0.0;            // amount of the unsharp mask on the grey values
  double sharpening_radius_px = 1.0;  // sigma of its Gaussian

  void Check() const;  // throws InputError
};

// Grey value of a light. Light beyond 0 to 255 is cut off where the curve is not linear.
double EncodeLight(const CameraResponse& response, double light);

// Tone curve and sharpening of a picture (CV_32FC3), channel by channel.
void ApplyResponse(const CameraResponse& response, cv::Mat* image);

}  // namespace velamap
