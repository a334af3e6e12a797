#include "importer/lighting/lighting.h"

#include <algorithm>
#include <cmath>

#include "importer/geometry/units.h"

namespace velamap {
namespace {

double BelowNormal(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }
double NormalDensity(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2 * kPi); }

}  // namespace

void Lighting::AddBand(const Band& band) {
  const Eigen::Index size = parameters_.size();
  parameters_.conservativeResize(size + kNumOfBand);
  parameters_.tail<kNumOfBand>() = band;
}

void Lighting::Move(const Eigen::VectorXd& step, double min_blur) {
  constexpr double kMaxBend = 4.0, kMaxAngleStep = 0.5, kMaxOffset = 1.0, kMaxOffsetStep = 0.2;
  constexpr double kMaxLogStep = 1.0, kMaxWidth = 3.0, kMaxBlur = 0.5;
  constexpr double kMinDepth = -4.0, kMaxDepth = 0.9;
  for (int i = kBend; i < kFirstBand; ++i) {
    parameters_[i] = std::clamp(parameters_[i] + step[i], -kMaxBend, kMaxBend);
  }
  for (Eigen::Index i = kFirstBand; i < parameters_.size(); i += kNumOfBand) {
    auto band = parameters_.segment<kNumOfBand>(i);
    const auto by = step.segment<kNumOfBand>(i);
    band[kAngle] += std::clamp(by[kAngle], -kMaxAngleStep, kMaxAngleStep);
    band[kOffset] =
        std::clamp(band[kOffset] + std::clamp(by[kOffset], -kMaxOffsetStep, kMaxOffsetStep),
                   -kMaxOffset, kMaxOffset);
    band[kLogBlur] =
        std::clamp(band[kLogBlur] + std::clamp(by[kLogBlur], -kMaxLogStep, kMaxLogStep),
                   std::log(min_blur), std::log(kMaxBlur));
    // A narrower band is the same as a weaker one.
    band[kLogWidth] =
        std::clamp(band[kLogWidth] + std::clamp(by[kLogWidth], -kMaxLogStep, kMaxLogStep),
                   std::log(min_blur), std::log(kMaxWidth));
    band[kDepth] = std::clamp(band[kDepth] + by[kDepth], kMinDepth, kMaxDepth);
  }
}

double Lighting::LogAt(const Eigen::Vector2d& place, Eigen::VectorXd* by_parameters) const {
  const double x = place.x(), y = place.y();
  const Eigen::Vector3d by_bend(x * x, x * y, y * y);
  double log_light = by_bend.dot(parameters_.head<kFirstBand>());
  if (by_parameters) by_parameters->head<kFirstBand>() = by_bend;
  for (Eigen::Index i = kFirstBand; i < parameters_.size(); i += kNumOfBand) {
    const auto band = parameters_.segment<kNumOfBand>(i);
    const double cosine = std::cos(band[kAngle]), sine = std::sin(band[kAngle]);
    const double width = std::exp(band[kLogWidth]), blur = std::exp(band[kLogBlur]);
    const double z1 = (cosine * x + sine * y - band[kOffset]) / blur, z2 = z1 - width / blur;
    const double inside = BelowNormal(z1) - BelowNormal(z2);
    const double left = 1 - band[kDepth] * inside;
    log_light += std::log(left);
    if (!by_parameters) continue;
    const double density1 = NormalDensity(z1), density2 = NormalDensity(z2);
    const double by_inside = -band[kDepth] / left;
    auto by = by_parameters->segment<kNumOfBand>(i);
    by[kAngle] = by_inside * (density1 - density2) * (cosine * y - sine * x) / blur;
    by[kOffset] = -by_inside * (density1 - density2) / blur;
    by[kLogWidth] = by_inside * density2 * width / blur;
    by[kLogBlur] = -by_inside * (z1 * density1 - z2 * density2);
    by[kDepth] = -inside / left;
  }
  return log_light;
}

}  // namespace velamap
