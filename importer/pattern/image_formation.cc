#include "importer/pattern/image_formation.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "importer/detect/interpolate.h"
#include "importer/geometry/units.h"

namespace velamap {
namespace {

constexpr double kWhite = 255.0;
constexpr int kUnsharpeningReachPx = 5;  // of the kernel that undoes the sharpening

double GrayOfLight(const ImageFormationParameters& parameters, double light) {
  const double v = std::pow(std::max(light, 0.0) / kWhite, 1 / parameters.gamma);
  return kWhite * (v - parameters.s_amplitude * std::sin(2 * kPi * v));
}

// With f the values before and g those after the sharpening, g = (1 + a) f - a G f is solved for
// f by the iteration f <- (g + a G f) / (1 + a), which contracts by a / (1 + a).
cv::Mat MakeUnsharpeningKernel(const ImageFormationParameters& parameters) {
  constexpr int kIterations = 60;
  const double a = parameters.sharpening;
  if (a == 0) return {};
  const int reach = 4 * kUnsharpeningReachPx, size = 2 * reach + 1;
  cv::Mat unit(size, size, CV_32F, cv::Scalar(0));
  unit.at<float>(reach, reach) = 1;
  cv::Mat kernel = unit.clone(), blurred;
  for (int i = 0; i < kIterations; ++i) {
    cv::GaussianBlur(kernel, blurred, {0, 0}, parameters.sharpening_radius_px);
    kernel = (unit + a * blurred) / (1 + a);
  }
  const int width = 2 * kUnsharpeningReachPx + 1;
  cv::Mat middle =
      kernel(cv::Rect(reach - kUnsharpeningReachPx, reach - kUnsharpeningReachPx, width, width))
          .clone();
  middle /= cv::sum(middle)[0];
  return middle;
}

Eigen::Vector2d InPatch(const GrayPatch& patch, const Eigen::Vector2d& x_px) {
  return x_px - Eigen::Vector2d(patch.origin_px.x, patch.origin_px.y);
}

// The light that the halo adds to each pixel. `light` includes it; without it, the light is to
// first order light + halo (light - G light), and the halo spreads its share of that by G.
cv::Mat ScatteredLight(const ImageFormationParameters& parameters, const cv::Mat& light) {
  const double halo = parameters.halo, radius_px = parameters.halo_radius_px;
  cv::Mat once, twice;
  cv::GaussianBlur(light, once, {0, 0}, radius_px, radius_px, cv::BORDER_REPLICATE);
  cv::GaussianBlur(once, twice, {0, 0}, radius_px, radius_px, cv::BORDER_REPLICATE);
  return halo * ((1 + halo) * once - halo * twice);
}

}  // namespace

ToneCurve::ToneCurve(const ImageFormationParameters& parameters)
    : is_linear_(parameters.gamma == 1.0 && parameters.s_amplitude == 0.0 &&
                 !parameters.is_inverted),
      sign_(parameters.is_inverted ? -1.0f : 1.0f),
      offset_(parameters.is_inverted ? static_cast<float>(kWhite) : 0.0f) {
  for (int i = 0; i <= kSteps; ++i) {
    const double root = static_cast<double>(i) * kMaxRoot / kSteps;
    gray_of_root_[static_cast<std::size_t>(i)] =
        static_cast<float>(GrayOfLight(parameters, std::min(root * root, kWhite)));
  }
  // Beyond white the curve keeps its last slope.
  const int white = static_cast<int>(std::sqrt(kWhite) / kMaxRoot * kSteps);
  const auto gray = [this](int i) -> float& { return gray_of_root_[static_cast<std::size_t>(i)]; };
  const float step = gray(white) - gray(white - 1);
  for (int i = white + 1; i <= kSteps; ++i) gray(i) = gray(i - 1) + step;
  for (std::size_t i = 0; i < first_above_gray_.size(); ++i) {
    first_above_gray_[i] =
        static_cast<int>(std::upper_bound(gray_of_root_.begin() + 1, gray_of_root_.end() - 1,
                                          static_cast<float>(i)) -
                         gray_of_root_.begin());
  }
  for (std::size_t i = 0; i < light_of_gray_.size(); ++i) {
    light_of_gray_[i] = static_cast<float>(Decode(static_cast<double>(i) / kStepsPerGray));
  }
}

double ToneCurve::Encode(double light) const {
  Floats slope;
  return static_cast<double>(Encode(AllLanes(light), &slope)[0]);
}

double ToneCurve::Decode(double gray) const {
  if (is_linear_) return gray;
  const double recorded = (gray - offset_) * sign_;
  const auto place = static_cast<float>(recorded);
  // std::clamp() would let NaN through.
  const auto* high =
      gray_of_root_.begin() +
      first_above_gray_[static_cast<std::size_t>(std::min(std::max(0.0, recorded), 255.0))];
  while (high < gray_of_root_.end() - 1 && *high <= place) ++high;
  const double low = *(high - 1), step = std::max(*high - low, 1e-6);
  const double idx =
      static_cast<double>(high - 1 - gray_of_root_.begin()) + (recorded - low) / step;
  const double root = std::max(0.0, idx * kMaxRoot / kSteps);
  return root * root;
}

void ToneCurve::Decode(cv::Mat* values) const {
  if (is_linear_) return;
  constexpr auto kWhiteGray = static_cast<float>(kWhite);
  for (float& value : cv::Mat_<float>(*values)) {
    if (!(value >= 0.0f && value < kWhiteGray)) {
      value = static_cast<float>(Decode(static_cast<double>(value)));
      continue;
    }
    const float place = value * kStepsPerGray;
    const auto i = static_cast<std::size_t>(place);
    const float rest = place - static_cast<float>(i);
    value = light_of_gray_[i] + rest * (light_of_gray_[i + 1] - light_of_gray_[i]);
  }
}

ImageFormation::ImageFormation(const ImageFormationParameters& parameters)
    : parameters_(parameters),
      tone_(parameters),
      unsharpening_(MakeUnsharpeningKernel(parameters)) {}

int PatchReachPx(const ImageFormation& formation) {
  const ImageFormationParameters& parameters = formation.parameters();
  int reach_px = formation.unsharpening().empty() ? 0 : kUnsharpeningReachPx;
  if (parameters.halo != 0) reach_px += static_cast<int>(std::ceil(3 * parameters.halo_radius_px));
  return reach_px;
}

GrayPatch CutPatch(const cv::Mat& gray, const cv::Rect& box, const ImageFormation& formation) {
  const cv::Rect image(0, 0, gray.cols, gray.rows);
  const cv::Rect inside = box & image;
  const ImageFormationParameters& parameters = formation.parameters();
  GrayPatch patch;
  patch.origin_px = inside.tl();
  const cv::Point reach(PatchReachPx(formation), PatchReachPx(formation));
  const cv::Rect wide = cv::Rect(inside.tl() - reach, inside.br() + reach) & image;
  cv::Mat values;
  gray(wide).convertTo(values, CV_32F);
  if (!formation.unsharpening().empty()) {
    // OpenCV filters pictures of floats four times as fast as those of bytes.
    cv::filter2D(values, values, CV_32F, formation.unsharpening(), {-1, -1}, 0,
                 cv::BORDER_REPLICATE);
  }
  const cv::Rect inside_wide = inside - wide.tl();
  patch.values = values(inside_wide).clone();
  if (parameters.halo != 0) {
    formation.tone().Decode(&values);
    patch.scattered_light = ScatteredLight(parameters, values)(inside_wide).clone();
  }
  return patch;
}

double LightAt(const GrayPatch& patch, const ImageFormation& formation,
               const Eigen::Vector2d& x_px) {
  const double light = formation.tone().Decode(InterpolatePatch(patch, x_px));
  if (patch.scattered_light.empty()) return light;
  const double scattered = InterpolateGray<float>(patch.scattered_light, InPatch(patch, x_px));
  return (light - scattered) / (1 - formation.parameters().halo);
}

void Sharpen(const ImageFormationParameters& parameters, int border, cv::Mat* values) {
  if (parameters.sharpening == 0) return;
  cv::Mat blurred;
  cv::GaussianBlur(*values, blurred, {0, 0}, parameters.sharpening_radius_px,
                   parameters.sharpening_radius_px, border);
  *values = (1 + parameters.sharpening) * *values - parameters.sharpening * blurred;
}

double InterpolatePatch(const GrayPatch& patch, const Eigen::Vector2d& x_px) {
  return InterpolateGray<float>(patch.values, InPatch(patch, x_px));
}

}  // namespace velamap
