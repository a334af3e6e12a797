#include "tests/support/render/picture_effects.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "importer/camera/calibration.h"

namespace velamap {
namespace {

// A line of the given length through the kernel's middle, sampled finely: symmetric, so that
// nothing moves.
cv::Mat MotionKernel(double length_px, double angle_rad) {
  constexpr int kNumSamples = 64;
  const int reach = static_cast<int>(std::ceil(0.5 * length_px)) + 1;
  cv::Mat kernel(2 * reach + 1, 2 * reach + 1, CV_32F, cv::Scalar(0));
  for (int i = 0; i < kNumSamples; ++i) {
    const double along = length_px * ((i + 0.5) / kNumSamples - 0.5);
    const double x = reach + along * std::cos(angle_rad), y = reach + along * std::sin(angle_rad);
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const double fx = x - column, fy = y - row;
    for (int dy = 0; dy < 2; ++dy) {
      for (int dx = 0; dx < 2; ++dx) {
        kernel.at<float>(row + dy, column + dx) +=
            static_cast<float>((dx ? fx : 1 - fx) * (dy ? fy : 1 - fy) / kNumSamples);
      }
    }
  }
  return kernel;
}

// An even disc; pixels at its border count by the share of them that it covers.
cv::Mat DiscKernel(double radius_px) {
  constexpr int kSubsamples = 16;
  const int reach = static_cast<int>(std::ceil(radius_px));
  const int size = kSubsamples * (2 * reach + 1);
  cv::Mat disc(size, size, CV_32F, cv::Scalar(0));
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double x = column + 0.5 - 0.5 * size, y = row + 0.5 - 0.5 * size;
      if (std::hypot(x, y) < kSubsamples * radius_px) disc.at<float>(row, column) = 1;
    }
  }
  cv::Mat kernel;
  cv::resize(disc, kernel, {2 * reach + 1, 2 * reach + 1}, 0, 0, cv::INTER_AREA);
  return kernel / cv::sum(kernel)[0];
}

cv::Mat GaussianBlurred(double sigma_px, const cv::Mat& image) {
  const int size = 2 * static_cast<int>(std::ceil(4 * sigma_px)) + 1;
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, {size, size}, sigma_px, 0, cv::BORDER_REPLICATE);
  return blurred;
}

}  // namespace

Camera FineCamera(const Camera& camera) {
  return ScaleToImageSize(camera, kFinePerSensorPx * camera.width_px,
                          kFinePerSensorPx * camera.height_px, "");
}

void MotionBlur(double length_px, double angle_rad, cv::Mat* fine) {
  if (length_px <= 0) return;
  cv::filter2D(*fine, *fine, -1, MotionKernel(kFinePerSensorPx * length_px, angle_rad), {-1, -1}, 0,
               cv::BORDER_REPLICATE);
}

void LensBlur(double sigma_px, cv::Mat* fine) {
  if (sigma_px > 0) *fine = GaussianBlurred(kFinePerSensorPx * sigma_px, *fine);
}

void DefocusBlur(double radius_px, cv::Mat* fine) {
  if (radius_px <= 0) return;
  cv::filter2D(*fine, *fine, -1, DiscKernel(kFinePerSensorPx * radius_px), {-1, -1}, 0,
               cv::BORDER_REPLICATE);
}

cv::Mat OnSensor(const cv::Mat& fine) {
  cv::Mat image;
  cv::resize(fine, image, fine.size() / kFinePerSensorPx, 0, 0, cv::INTER_AREA);
  return image;
}

void Halo(double share, double sigma_px, cv::Mat* image) {
  if (share <= 0) return;
  cv::addWeighted(*image, 1 - share, GaussianBlurred(sigma_px, *image), share, 0, *image);
}

void AddNoise(double sigma, double shot_sigma, std::uint64_t seed, cv::Mat* image) {
  if (sigma <= 0 && shot_sigma <= 0) return;
  cv::RNG random(seed);
  cv::Mat noise(image->size(), CV_32FC1);
  // Without shot noise drawn as ever, so that the bytes stay.
  random.fill(noise, cv::RNG::NORMAL, 0.0, shot_sigma > 0 ? 1.0 : sigma);
  const auto reading = static_cast<float>(sigma * sigma);
  const auto shot = static_cast<float>(shot_sigma * shot_sigma / 255);
  for (int row = 0; row < image->rows; ++row) {
    cv::Vec3f* pixels = image->ptr<cv::Vec3f>(row);
    const float* values = noise.ptr<float>(row);
    for (int column = 0; column < image->cols; ++column) {
      const float scale =
          shot > 0 ? std::sqrt(reading + shot * std::max(0.0F, pixels[column][1])) : 1.0F;
      pixels[column] += cv::Vec3f::all(scale * values[column]);
    }
  }
}

}  // namespace velamap
