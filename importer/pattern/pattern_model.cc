#include "importer/pattern/pattern_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "importer/detect/interpolate.h"

namespace velamap {
namespace {

using P = PatternParameters;

// The fraction of a blurred place within the rows (or columns) of the black square, and the
// fraction within these and the quiet zone.
struct Within {
  double square = 1.0, quiet_zone = 1.0;
};

// Place along one axis where the surroundings are read: the middle of their first cell, or one
// sigma of the blur beyond the quiet zone if that is further out.
class RingReading {
 public:
  RingReading(double blur_cells, double margin_low, double margin_high)
      : beyond_cells_(std::max(0.5, blur_cells)),
        margin_low_(margin_low),
        margin_high_(margin_high),
        blur_cells_(blur_cells) {}

  // Place of cell `i` of `n`, in sides of the square.
  double Place(int i, int n) const {
    if (i == -kRing) return -(margin_low_ + beyond_cells_) / n;
    if (i == n + kRing - 1) return 1 + (margin_high_ + beyond_cells_) / n;
    return (i + 0.5) / n;
  }

  // Only the cells of the outer ring are affected; all others are taken to lie wholly inside.
  Within Weights(int i, int n) const {
    if (i != -kRing && i != n + kRing - 1) return {};
    const double margin = i < 0 ? margin_low_ : margin_high_;
    return {NormalDistribution(-(margin + beyond_cells_) / blur_cells_),
            NormalDistribution(-beyond_cells_ / blur_cells_)};
  }

 private:
  static double NormalDistribution(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

  double beyond_cells_, margin_low_, margin_high_, blur_cells_;
};

double LightingAt(const PatternModel& model, const Eigen::Vector2d& x_px) {
  if (model.lighting.empty()) return 1.0;
  return InterpolateGray<float>(model.lighting, x_px - model.center_px + model.center_in_patch_px);
}

}  // namespace

QuadCorners CornersOf(const P::Vector& parameters) {
  QuadCorners quad;
  for (int i = 0; i < kNumCorners; ++i) {
    quad[static_cast<std::size_t>(i)] = parameters.segment<2>(P::kCorners + 2 * i);
  }
  return quad;
}

Eigen::Vector2d BlurInCells(const P::Vector& parameters, int num_cells) {
  const QuadCorners quad = CornersOf(parameters);
  const Eigen::Vector2d along_u = 0.5 * (quad[1] - quad[0] + quad[2] - quad[3]);
  const Eigen::Vector2d along_v = 0.5 * (quad[3] - quad[0] + quad[2] - quad[1]);
  const double area = std::abs(along_u.x() * along_v.y() - along_u.y() * along_v.x());
  return num_cells / area *
         Eigen::Vector2d(parameters[P::kBlurU] * along_v.norm(),
                         parameters[P::kBlurV] * along_u.norm());
}

void FillLightness(const GrayPatch& patch, const cv::Mat& cells, const P::Vector& parameters,
                   PatternModel* model) {
  const UnitSquareMap map(CornersOf(parameters));
  const int n = model->num_cells;
  const Eigen::Vector2d blur_cells = BlurInCells(parameters, n);
  const auto margin = parameters.segment<4>(P::kMargin);
  const RingReading across_u(blur_cells.x(), margin[0], margin[1]);
  const RingReading across_v(blur_cells.y(), margin[2], margin[3]);
  const double dark = parameters[P::kDark], contrast = parameters[P::kLight] - dark;
  model->inner = {};
  for (int j = -kRing; j < n + kRing; ++j) {
    for (int i = -kRing; i < n + kRing; ++i) {
      const int outside = std::max({-i, i - n + 1, -j, j - n + 1});
      float surround = 0.0f;
      if (outside <= 0) {
        const std::int32_t is_light = cells.at<std::uint8_t>(j, i) != 0;
        model->inner[static_cast<std::size_t>(j + kRing)] |= is_light << (i + kRing);
      } else if (outside == kRing) {
        const Eigen::Vector2d uv(across_u.Place(i, n), across_v.Place(j, n));
        const Eigen::Vector2d x_px = map.ToImage(uv.x(), uv.y());
        const double value = LightAt(patch, *model->formation, x_px) / LightingAt(*model, x_px);
        const Within u = across_u.Weights(i, n), v = across_v.Weights(j, n);
        const double surround_share = 1 - u.quiet_zone * v.quiet_zone;
        const double read = (value - dark) / contrast - 1 + u.square * v.square;
        surround = static_cast<float>(std::clamp(read / surround_share, -1.2, 0.5));
      }
      model->surround(j + kRing, i + kRing) = surround;
    }
  }
}

}  // namespace velamap
