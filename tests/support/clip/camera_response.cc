#include "tests/support/clip/camera_response.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "tests/support/tool_options.h"

namespace velamap {
namespace {

constexpr double kWhite = 255.0;

double EncodeSrgb(double x) {
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

// A smoothstep over a bent axis less the axis itself: the toe goes down over 0.46 of the way, the
// longer shoulder up over 0.54. Black and white stay.
double FilmicS(double v) {
  constexpr double kBend = 0.15;
  const double t = v + kBend * v * (1 - v);
  return t * t * (3 - 2 * t) - t;
}

// The largest value of |FilmicS|: that of smoothstep(t) - t.
const double kLargestS = 1 / (6 * std::sqrt(3.0));

// Part of white of a part of full light.
double Encode(const CameraResponse& response, double x) {
  switch (response.tone_curve) {
    case ToneCurveKind::kLinear:
      return x;
    case ToneCurveKind::kSrgb:
      return EncodeSrgb(x);
    case ToneCurveKind::kGamma:
      return std::pow(x, 1 / response.gamma);
    case ToneCurveKind::kSCurve: {
      const double v = EncodeSrgb(x);
      return v + response.s_curve / kLargestS * FilmicS(v);
    }
  }
  throw std::logic_error("unknown tone curve");
}

// A table is exact to 0.01 grey levels on a square-root axis, on which all curves are smooth, and
// spares a pow for each value.
class ResponseTable {
 public:
  explicit ResponseTable(const CameraResponse& response) {
    for (int i = 0; i <= kSteps; ++i) {
      const double root = static_cast<double>(i) / kSteps;
      gray_.push_back(static_cast<float>(EncodeLight(response, kWhite * root * root)));
    }
  }

  float operator()(float light) const {
    const float root = std::sqrt(std::clamp(light / static_cast<float>(kWhite), 0.0F, 1.0F));
    const float place = root * kSteps;
    const auto i = static_cast<std::size_t>(std::min(place, kSteps - 1.0F));
    return gray_[i] + (place - static_cast<float>(i)) * (gray_[i + 1] - gray_[i]);
  }

 private:
  static constexpr int kSteps = 4096;
  std::vector<float> gray_;
};

}  // namespace

void CameraResponse::Check() const {
  CheckOptionRange("gamma", gamma, 1, 3);
  CheckOptionRange("s_curve", s_curve, 0, 0.08);
  CheckOptionRange("sharpening", sharpening, 0, 3);
  CheckOptionRange("sharpening_radius_px", sharpening_radius_px, 0.3, 5);
}

double EncodeLight(const CameraResponse& response, double light) {
  if (response.tone_curve == ToneCurveKind::kLinear) return light;
  return kWhite * Encode(response, std::clamp(light / kWhite, 0.0, 1.0));
}

void ApplyResponse(const CameraResponse& response, cv::Mat* image) {
  if (response.tone_curve != ToneCurveKind::kLinear) {
    const ResponseTable table(response);
    for (int row = 0; row < image->rows; ++row) {
      float* values = image->ptr<float>(row);
      for (int i = 0; i < image->cols * image->channels(); ++i) values[i] = table(values[i]);
    }
  }
  if (response.sharpening > 0) {
    const int size = 2 * static_cast<int>(std::ceil(4 * response.sharpening_radius_px)) + 1;
    cv::Mat blurred;
    cv::GaussianBlur(*image, blurred, {size, size}, response.sharpening_radius_px, 0,
                     cv::BORDER_REPLICATE);
    cv::addWeighted(*image, 1 + response.sharpening, blurred, -response.sharpening, 0, *image);
  }
}

}  // namespace velamap
