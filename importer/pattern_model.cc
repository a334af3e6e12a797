#include "importer/pattern_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "importer/interpolate.h"

namespace velamap {
namespace {

using P = PatternParameters;

constexpr double kMarginInCells = 0.75;  // how far outside the black square pixels are used

// Zero at both ends of a side, one in its middle.
Floats Hump(Floats place) { return 4.0f * place * (1.0f - place); }

// Sigma of the blur across columns and across rows, in cells of the marker's middle.
Eigen::Vector2d BlurInCells(const P::Vector& parameters,
                            const std::array<Eigen::Vector2d, kNumCorners>& quad, int num_cells) {
  const Eigen::Vector2d along_u = 0.5 * (quad[1] - quad[0] + quad[2] - quad[3]);
  const Eigen::Vector2d along_v = 0.5 * (quad[3] - quad[0] + quad[2] - quad[1]);
  const double area = std::abs(along_u.x() * along_v.y() - along_u.y() * along_v.x());
  return num_cells / area *
         Eigen::Vector2d(parameters[P::kBlurU] * along_v.norm(),
                         parameters[P::kBlurV] * along_u.norm());
}

// How much of a blurred place lies within the rows (or columns) of the black square, and within
// those and the quiet zone's.
struct Within {
  double square = 1.0, quiet_zone = 1.0;
};

// Where the surroundings are read along one axis: the middle of their first cell, or a sigma of the
// blur beyond the quiet zone if that is further out.
class RingReading {
 public:
  explicit RingReading(double blur_cells)
      : beyond_cells_(std::max(0.5, blur_cells)),
        at_ring_{NormalDistribution(-(1 + beyond_cells_) / blur_cells),
                 NormalDistribution(-beyond_cells_ / blur_cells)} {}

  // Of cell `i` of `n`, in sides of the square.
  double Place(int i, int n) const {
    if (i == -kRing) return -(1 + beyond_cells_) / n;
    if (i == n + kRing - 1) return 1 + (1 + beyond_cells_) / n;
    return (i + 0.5) / n;
  }

  // The other cells are taken to lie deep within.
  Within Weights(int i, int n) const {
    return i == -kRing || i == n + kRing - 1 ? at_ring_ : Within{};
  }

 private:
  static double NormalDistribution(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

  double beyond_cells_;
  Within at_ring_;
};

}  // namespace

std::array<Eigen::Vector2d, kNumCorners> CornersOf(const P::Vector& parameters) {
  std::array<Eigen::Vector2d, kNumCorners> quad;
  for (int i = 0; i < kNumCorners; ++i) {
    quad[static_cast<std::size_t>(i)] = parameters.segment<2>(P::kCorners + 2 * i);
  }
  return quad;
}

double FillLightness(const cv::Mat& gray, const cv::Mat& cells, const P::Vector& parameters,
                     PatternModel* model) {
  const std::array<Eigen::Vector2d, kNumCorners> quad = CornersOf(parameters);
  const UnitSquareMap map(quad);
  const int n = model->num_cells;
  const Eigen::Vector2d blur_cells = BlurInCells(parameters, quad, n);
  const RingReading across_u(blur_cells.x()), across_v(blur_cells.y());
  const double dark = parameters[P::kDark], contrast = parameters[P::kLight] - dark;
  for (int j = -kRing; j < n + kRing; ++j) {
    for (int i = -kRing; i < n + kRing; ++i) {
      const int outside = std::max({-i, i - n + 1, -j, j - n + 1});
      float lightness = 0.0f, ring = outside > 0 ? 1.0f : 0.0f, surround = 0.0f;
      if (outside <= 0) {
        lightness = cells.at<std::uint8_t>(j, i) != 0 ? 1.0f : 0.0f;
      } else if (outside == kRing) {
        const Eigen::Vector2d uv(across_u.Place(i, n), across_v.Place(j, n));
        const double value = InterpolateGray(gray, map.ToImage(uv.x(), uv.y()));
        const Within u = across_u.Weights(i, n), v = across_v.Weights(j, n);
        const double surround_share = 1 - u.quiet_zone * v.quiet_zone;
        const double read = (value - dark) / contrast - 1 + u.square * v.square;
        surround = static_cast<float>(std::clamp(read / surround_share, -1.0, 0.2));
      }
      model->inner(j + kRing, i + kRing) = lightness;
      model->ring(j + kRing, i + kRing) = ring;
      model->surround(j + kRing, i + kRing) = surround;
    }
  }
  return blur_cells.maxCoeff();
}

PatternPicture::PatternPicture(const PatternModel& model, const P::Vector& parameters)
    : model_(model), parameters_(parameters) {
  std::array<Eigen::Vector2d, kNumCorners> quad = CornersOf(parameters);
  for (Eigen::Vector2d& corner : quad) corner -= model.center_px;
  square_from_image_ = UnitSquareMap(quad).square_from_image().cast<float>();
  const int n = model.num_cells + 2 * kRing;
  print_.topLeftCorner(n, n) =
      static_cast<float>(parameters[P::kInnerLight]) * model.inner.topLeftCorner(n, n) +
      model.ring.topLeftCorner(n, n);
}

Blended PatternPicture::BlendAll(const Shares& u, const Shares& v, Floats correlation_px,
                                 Floats* inner_value, Floats* surround_value) const {
  const int n = model_.num_cells;
  Blended pattern;
  if (Reaches(kRing, u, n) || Reaches(kRing, v, n)) {
    pattern = Blend(print_, u, v);
    *inner_value = BlendValue(model_.inner, u, v);
  } else {
    const Blended inner = Blend(model_.inner, u, v);
    Add(AllLanes(parameters_[P::kInnerLight]), inner, &pattern);
    *inner_value = inner.value;
  }
  AddCorrelation(correlation_px, &pattern);
  *surround_value = Floats{};
  if (Reaches(1, u, n) || Reaches(1, v, n)) {
    const Blended around = Blend(model_.surround, u, v);
    *surround_value = around.value;
    Add(AllLanes(parameters_[P::kSurround]), around, &pattern);
  }
  return pattern;
}

PatternPicture::Place PatternPicture::ToSquare(Floats x, Floats y) const {
  const Eigen::Matrix3f& m = square_from_image_;
  const Floats scale = 1.0f / (m(2, 0) * x + m(2, 1) * y + m(2, 2));
  const Floats flat_u = scale * (m(0, 0) * x + m(0, 1) * y + m(0, 2));
  const Floats flat_v = scale * (m(1, 0) * x + m(1, 1) * y + m(1, 2));
  Place place{flat_u,
              flat_v,
              scale * (m(0, 0) - flat_u * m(2, 0)),
              scale * (m(0, 1) - flat_u * m(2, 1)),
              scale * (m(1, 0) - flat_v * m(2, 0)),
              scale * (m(1, 1) - flat_v * m(2, 1))};
  const Eigen::Vector4f bends = parameters_.segment<4>(P::kBendU).cast<float>();
  for (int i = 0; i < 2; ++i) {
    const Floats hump_u = Hump(place.u), hump_v = Hump(place.v);
    const Floats bend_x = hump_u * bends[0] + hump_v * bends[2];
    const Floats bend_y = hump_u * bends[1] + hump_v * bends[3];
    place.u = flat_u - place.u_by_x * bend_x - place.u_by_y * bend_y;
    place.v = flat_v - place.v_by_x * bend_x - place.v_by_y * bend_y;
  }
  return place;
}

Ints PatternPicture::Covers(Floats x, Floats y) const {
  const Place place = ToSquare(x, y);
  const auto margin = static_cast<float>(kMarginInCells / model_.num_cells);
  return (Min(place.u, place.v) > -margin) & (Max(place.u, place.v) < 1.0f + margin);
}

void PatternPicture::At(Floats x, Floats y, PatternPixels* pixels) const {
  const Eigen::Matrix<float, P::kCount, 1> p = parameters_.cast<float>();
  const Place flat = ToSquare(x, y);
  const auto n = static_cast<float>(model_.num_cells);
  const Floats u_by_x = n * flat.u_by_x, u_by_y = n * flat.u_by_y;  // cells/px
  const Floats v_by_x = n * flat.v_by_x, v_by_y = n * flat.v_by_y;
  const Floats cells_u = Sqrt(u_by_x * u_by_x + u_by_y * u_by_y);
  const Floats cells_v = Sqrt(v_by_x * v_by_x + v_by_y * v_by_y);
  Shares u, v;
  ComputeShares(n * flat.u, cells_u * p[P::kBlurU], model_.num_cells, &u);
  ComputeShares(n * flat.v, cells_v * p[P::kBlurV], model_.num_cells, &v);
  Floats inner{}, surround{};
  const Blended pattern = BlendAll(
      u, v, p[P::kBlurU] * p[P::kBlurV] * (u_by_x * v_by_x + u_by_y * v_by_y), &inner, &surround);

  const auto inverse_diagonal = static_cast<float>(1 / model_.diagonal_px);
  const Floats place_x = inverse_diagonal * x, place_y = inverse_diagonal * y;
  const Floats light = 1.0f + p[P::kGradientX] * place_x + p[P::kGradientY] * place_y;
  const float step = p[P::kLight] - p[P::kDark];
  const Floats contrast = light * step;
  const Floats level = p[P::kDark] + step * pattern.value;
  const Floats by_x = contrast * (u_by_x * pattern.by_u + v_by_x * pattern.by_v);
  const Floats by_y = contrast * (u_by_y * pattern.by_u + v_by_y * pattern.by_v);
  pixels->gray = light * level;
  std::array<Floats, P::kCount>& jacobian = pixels->jacobian;
  const auto set_place = [&](std::size_t index, Floats share) {
    jacobian[index] = -share * by_x;
    jacobian[index + 1] = -share * by_y;
  };
  // A corner that moves takes each place along by its bilinear share, nearly enough for a step.
  set_place(P::kCorners, (1.0f - flat.u) * (1.0f - flat.v));
  set_place(P::kCorners + 2, flat.u * (1.0f - flat.v));
  set_place(P::kCorners + 4, flat.u * flat.v);
  set_place(P::kCorners + 6, (1.0f - flat.u) * flat.v);
  set_place(P::kBendU, Hump(flat.u));
  set_place(P::kBendV, Hump(flat.v));
  jacobian[P::kBlurU] = contrast * cells_u * pattern.by_blur_u;
  jacobian[P::kBlurV] = contrast * cells_v * pattern.by_blur_v;
  jacobian[P::kDark] = light * (1.0f - pattern.value);
  jacobian[P::kLight] = light * pattern.value;
  jacobian[P::kGradientX] = level * place_x;
  jacobian[P::kGradientY] = level * place_y;
  jacobian[P::kSurround] = contrast * surround;
  jacobian[P::kInnerLight] = contrast * inner;
}

}  // namespace velamap
