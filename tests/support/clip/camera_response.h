// Converts light to grey values as a camera does: tone curve, then sharpening.
//
// Light and grey values range from 0 to 255. Light is linear, and 255 saturates the sensor. The
// tone curves are deliberately not of the family that importer/pattern/image_formation.h fits.

#pragma once

#include <opencv2/core.hpp>

namespace velamap {

enum class ToneCurveKind {
  kLinear,  // grey values equal light, as in a machine-vision camera
  kSrgb,    // IEC 61966-2-1: a line below 0.3 % of light, a power 2.4 with an offset above
  kGamma,   // light^(1 / gamma)
  kSCurve,  // sRGB, then a filmic contrast with a toe and a longer shoulder
};

struct CameraResponse {
  ToneCurveKind tone_curve = ToneCurveKind::kLinear;
  double gamma = 2.2;                 // of kGamma
  double s_curve = 0.0;               // of kSCurve: its largest effect on an encoded value / white
  double sharpening = 0.0;            // amount of the unsharp mask on the grey values
  double sharpening_radius_px = 1.0;  // sigma of its Gaussian

  void Check() const;  // throws InputError
};

// The grey value of a light. Unless the curve is linear, light is clamped to 0 to 255.
double EncodeLight(const CameraResponse& response, double light);

// Applies tone curve and sharpening to a picture (CV_32FC3), channel by channel.
void ApplyResponse(const CameraResponse& response, cv::Mat* image);

}  // namespace velamap
