#include "importer/pattern_model.h"

#include <algorithm>
#include <cstdint>

#include "importer/interpolate.h"

namespace velamap {
namespace {

using P = PatternParameters;

constexpr double kMarginInCells = 0.75;  // how far outside the black square pixels are used

// Zero at both ends of a side, one in its middle.
double Hump(double place) { return 4 * place * (1 - place); }

Eigen::Vector2d Bend(const P::Vector& p, const Eigen::Vector2d& uv) {
  return Hump(uv.x()) * p.segment<2>(P::kBendU) + Hump(uv.y()) * p.segment<2>(P::kBendV);
}

}  // namespace

std::array<Eigen::Vector2d, kNumCorners> CornersOf(const P::Vector& parameters) {
  std::array<Eigen::Vector2d, kNumCorners> quad;
  for (int i = 0; i < kNumCorners; ++i) {
    quad[static_cast<std::size_t>(i)] = parameters.segment<2>(P::kCorners + 2 * i);
  }
  return quad;
}

void FillLightness(const cv::Mat& gray, const cv::Mat& cells, const UnitSquareMap& map, double dark,
                   double light, PatternModel* model) {
  const int n = model->num_cells;
  for (int j = -kRing; j < n + kRing; ++j) {
    for (int i = -kRing; i < n + kRing; ++i) {
      const int outside = std::max({-i, i - n + 1, -j, j - n + 1});
      double lightness = 0.0, ring = outside > 0, surround = 0.0;
      if (outside <= 0) {
        lightness = cells.at<std::uint8_t>(j, i) != 0;
      } else if (outside == kRing) {
        const double value = InterpolateGray(gray, map.ToImage((i + 0.5) / n, (j + 0.5) / n));
        surround = std::clamp((value - light) / (light - dark), -1.0, 0.2);
      }
      model->inner(j + kRing, i + kRing) = lightness;
      model->ring(j + kRing, i + kRing) = ring;
      model->surround(j + kRing, i + kRing) = surround;
    }
  }
}

PatternPicture::PatternPicture(const PatternModel& model, const P::Vector& parameters)
    : model_(model), parameters_(parameters), map_(CornersOf(parameters)) {
  const int n = model.num_cells + 2 * kRing;
  print_.topLeftCorner(n, n) =
      parameters[P::kInnerLight] * model.inner.topLeftCorner(n, n) + model.ring.topLeftCorner(n, n);
}

Blended PatternPicture::BlendAll(const Shares& u, const Shares& v, double correlation_px,
                                 double* inner_value, double* surround_value) const {
  const int n = model_.num_cells;
  Blended pattern;
  if (Reaches(kRing, u, n) || Reaches(kRing, v, n)) {
    pattern = Blend(print_, u, v);
    *inner_value = BlendValue(model_.inner, u, v);
  } else {
    const Blended inner = Blend(model_.inner, u, v);
    Add(parameters_[P::kInnerLight], inner, &pattern);
    *inner_value = inner.value;
  }
  AddCorrelation(correlation_px, &pattern);
  *surround_value = 0.0;
  if (Reaches(1, u, n) || Reaches(1, v, n)) {
    const Blended around = Blend(model_.surround, u, v);
    *surround_value = around.value;
    Add(parameters_[P::kSurround], around, &pattern);
  }
  return pattern;
}

bool PatternPicture::At(const Eigen::Vector2d& x_px, PatternPixel* pixel) const {
  const P::Vector& p = parameters_;
  Eigen::Vector2d flat_uv;
  Eigen::Matrix2d flat_gradient;
  map_.ToSquare(x_px, &flat_uv, &flat_gradient);
  Eigen::Vector2d uv = flat_uv;
  for (int i = 0; i < 2; ++i) uv = flat_uv - flat_gradient * Bend(p, uv);
  const double n = model_.num_cells;
  const double margin = kMarginInCells / n;
  if (!(uv.minCoeff() > -margin && uv.maxCoeff() < 1 + margin)) return false;
  const Eigen::Matrix2d gradient = n * flat_gradient;  // cells/px
  const double cells_u = gradient.row(0).norm(), cells_v = gradient.row(1).norm();
  Shares u, v;
  ComputeShares(n * uv.x(), cells_u * p[P::kBlurU], model_.num_cells, &u);
  ComputeShares(n * uv.y(), cells_v * p[P::kBlurV], model_.num_cells, &v);
  double inner = 0.0, surround = 0.0;
  const Blended pattern = BlendAll(
      u, v, p[P::kBlurU] * p[P::kBlurV] * gradient.row(0).dot(gradient.row(1)), &inner, &surround);

  const Eigen::Vector2d place = (x_px - model_.center_px) / model_.diagonal_px;
  const double light = 1 + p[P::kGradientX] * place.x() + p[P::kGradientY] * place.y();
  const double contrast = light * (p[P::kLight] - p[P::kDark]);
  const double level = p[P::kDark] + (p[P::kLight] - p[P::kDark]) * pattern.value;
  const Eigen::Vector2d by_place =
      contrast * gradient.transpose() * Eigen::Vector2d(pattern.by_u, pattern.by_v);
  // A corner that moves takes each place along by its bilinear share, nearly enough for a step.
  const std::array<double, kNumCorners> share = {(1 - uv.x()) * (1 - uv.y()), uv.x() * (1 - uv.y()),
                                                 uv.x() * uv.y(), (1 - uv.x()) * uv.y()};
  pixel->gray = light * level;
  P::Vector jacobian;
  for (int i = 0; i < kNumCorners; ++i) {
    jacobian.segment<2>(2 * i) = -share[static_cast<std::size_t>(i)] * by_place;
  }
  jacobian.segment<2>(P::kBendU) = -Hump(uv.x()) * by_place;
  jacobian.segment<2>(P::kBendV) = -Hump(uv.y()) * by_place;
  jacobian[P::kBlurU] = contrast * cells_u * pattern.by_blur_u;
  jacobian[P::kBlurV] = contrast * cells_v * pattern.by_blur_v;
  jacobian[P::kDark] = light * (1 - pattern.value);
  jacobian[P::kLight] = light * pattern.value;
  jacobian[P::kGradientX] = level * place.x();
  jacobian[P::kGradientY] = level * place.y();
  jacobian[P::kSurround] = contrast * surround;
  jacobian[P::kInnerLight] = contrast * inner;
  pixel->jacobian = jacobian.cast<float>();
  return true;
}

}  // namespace velamap
