#include "importer/refine/camera_response.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace velamap {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kKernelReach = 5;

double GrayOf(const CameraResponse& response, double light) {
  if (response.is_inverted) {
    CameraResponse upright = response;
    upright.is_inverted = false;
    return 255 - GrayOf(upright, 255 - light);
  }
  const double v = std::pow(std::max(light, 0.0) / 255, 1 / response.gamma);
  return 255 * (v - response.s_amplitude * std::sin(2 * kPi * v));
}

}  // namespace

ToneCurve::ToneCurve(const CameraResponse& response)
    : is_linear_(response.gamma == 1.0 && response.s_amplitude == 0.0) {
  for (int i = 0; i <= kSteps; ++i) {
    const double root = static_cast<double>(i) * kMaxRoot / kSteps;
    gray_of_root_[static_cast<std::size_t>(i)] =
        static_cast<float>(GrayOf(response, std::min(root * root, 255.0)));
  }
  if (is_linear_) return;
  // Beyond white the curve goes on as it ends.
  const int white = static_cast<int>(std::sqrt(255.0) / kMaxRoot * kSteps);
  const float step = gray_of_root_[static_cast<std::size_t>(white)] -
                     gray_of_root_[static_cast<std::size_t>(white - 1)];
  for (int i = white + 1; i <= kSteps; ++i) {
    gray_of_root_[static_cast<std::size_t>(i)] =
        gray_of_root_[static_cast<std::size_t>(i - 1)] + step;
  }
}

double ToneCurve::Encode(double light) const {
  Floats slope;
  return static_cast<double>(Encode(AllLanes(light), &slope)[0]);
}

double ToneCurve::Decode(double gray) const {
  if (is_linear_) return gray;
  const auto found = std::upper_bound(gray_of_root_.begin() + 1, gray_of_root_.end() - 1,
                                      static_cast<float>(gray));
  const auto i = found - gray_of_root_.begin();
  const double low = gray_of_root_[static_cast<std::size_t>(i - 1)], high = *found;
  const double root =
      (static_cast<double>(i - 1) + (gray - low) / std::max(high - low, 1e-6)) * kMaxRoot / kSteps;
  return root > 0 ? root * root : 0.0;
}

cv::Mat UnsharpeningKernel(const CameraResponse& response) {
  if (response.sharpening == 0) return {};
  const int reach = 4 * kKernelReach, size = 2 * reach + 1;
  cv::Mat unit(size, size, CV_32F, cv::Scalar(0));
  unit.at<float>(reach, reach) = 1;
  cv::Mat kernel = unit.clone(), blurred;
  for (int i = 0; i < 60; ++i) {
    cv::GaussianBlur(kernel, blurred, {0, 0}, response.sharpening_radius_px);
    kernel = (unit + response.sharpening * blurred) / (1 + response.sharpening);
  }
  const cv::Rect middle(reach - kKernelReach, reach - kKernelReach, 2 * kKernelReach + 1,
                        2 * kKernelReach + 1);
  cv::Mat cut = kernel(middle).clone();
  cut /= cv::sum(cut)[0];
  return cut;
}

double InterpolatePatch(const GrayPatch& patch, const Eigen::Vector2d& x_px) {
  const cv::Mat& values = patch.values;
  const double x = std::clamp(x_px.x() - patch.origin_px.x, 0.0, values.cols - 1.001);
  const double y = std::clamp(x_px.y() - patch.origin_px.y, 0.0, values.rows - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double fx = x - column, fy = y - row;
  const float* upper = values.ptr<float>(row) + column;
  const float* lower = values.ptr<float>(row + 1) + column;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) +
         fy * ((1 - fx) * lower[0] + fx * lower[1]);
}

GrayPatch Linearized(GrayPatch patch, const ToneCurve& tone) {
  if (tone.IsLinear()) return patch;
  patch.values.forEach<float>(
      [&tone](float& value, const int*) { value = static_cast<float>(tone.Decode(value)); });
  return patch;
}

GrayPatch CutPatch(const cv::Mat& gray, const cv::Rect& box, const cv::Mat& unsharpening) {
  const cv::Rect image(0, 0, gray.cols, gray.rows);
  GrayPatch patch;
  if (unsharpening.empty()) {
    const cv::Rect inside = box & image;
    patch.origin_px = inside.tl();
    gray(inside).convertTo(patch.values, CV_32F);
    return patch;
  }
  const cv::Rect inside = box & image;
  const cv::Point reach(kKernelReach, kKernelReach);
  const cv::Rect wide = cv::Rect(inside.tl() - reach, inside.br() + reach) & image;
  cv::Mat values, filtered;
  gray(wide).convertTo(values, CV_32F);
  cv::filter2D(values, filtered, CV_32F, unsharpening, {-1, -1}, 0, cv::BORDER_REPLICATE);
  patch.origin_px = inside.tl();
  patch.values = filtered(inside - wide.tl()).clone();
  return patch;
}

}  // namespace velamap
