#include "importer/corner_refinement.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "importer/edge_fit.h"
#include "importer/error.h"
#include "importer/interpolate.h"
#include "importer/pattern_fit.h"
#include "importer/unit_square_map.h"

namespace velamap {
namespace {

using Quad = std::array<Eigen::Vector2d, kNumCorners>;

constexpr double kQuietZoneCells = 1.0;  // what every marker has; more does no harm
constexpr double kMinContrast = 12.0;    // grey levels
constexpr double kMaxRelativeRms = 0.2;  // of the residuals, by contrast
constexpr double kFirstBlurPx = 1.0;
// Places along a side where the cells beyond the border and the quiet zone are looked up.
constexpr int kNumPlaces = 33;

struct Pass {
  double band_px;
  int max_samples;  // of a side
  double tolerance_px;
};

// One side from corner 0 to 1 of a quad turned to start there; the marker lies at v > 0.
struct Side {
  Eigen::Vector2d middle_px, along, outward;  // unit vectors
  double half_length_px;
};

Side MakeSide(const Quad& quad) {
  Side side{0.5 * (quad[0] + quad[1]),
            (quad[1] - quad[0]).normalized(),
            {},
            0.5 * (quad[1] - quad[0]).norm()};
  side.outward = {side.along.y(), -side.along.x()};
  if (side.outward.dot(quad[2] + quad[3] - 2 * side.middle_px) > 0) side.outward *= -1;
  return side;
}

// Grey values along a line parallel to the side, v cells inside it.
using GrayLine = std::array<double, kNumPlaces>;

GrayLine ReadLine(const cv::Mat& gray, const UnitSquareMap& map, double v) {
  GrayLine line;
  for (int i = 0; i < kNumPlaces; ++i) {
    line[static_cast<std::size_t>(i)] =
        InterpolateGray(gray, map.ToImage(i / (kNumPlaces - 1.0), v));
  }
  return line;
}

double Mean(const GrayLine& line) {
  double sum = 0.0;
  for (const double value : line) sum += value;
  return sum / kNumPlaces;
}

double LookUp(const GrayLine& line, double u) {
  const double place = std::clamp(u, 0.0, 1.0) * (kNumPlaces - 1.001);
  const auto index = static_cast<std::size_t>(place);
  return line[index] + (place - static_cast<double>(index)) * (line[index + 1] - line[index]);
}

// Linear in s along the side.
struct LinearInS {
  double middle, slope;
  double operator()(double s) const { return middle + slope * s; }
};

LinearInS FromEnds(double at_start, double at_end) {
  return {0.5 * (at_start + at_end), 0.5 * (at_end - at_start)};
}

// A line of the print parallel to the side, at v in the unit square: how far it is from the side,
// and the place u on it that faces a place s of the side.
struct Parallel {
  LinearInS depth_px, u;
};

Parallel MakeParallel(const Side& side, const UnitSquareMap& map, double v) {
  const auto depth_px = [&](double u) {
    return std::abs((map.ToImage(u, v) - side.middle_px).dot(side.outward));
  };
  const Parallel line{FromEnds(depth_px(0), depth_px(1)), {}};
  const auto facing_u = [&](double s) {
    const double outwards_px = v > 0 ? -line.depth_px(s) : line.depth_px(s);
    return map
        .ToSquare(side.middle_px + s * side.half_length_px * side.along +
                  outwards_px * side.outward)
        .x();
  };
  return {line.depth_px, FromEnds(facing_u(-1), facing_u(1))};
}

// Share of a step that lies on the far side, for the sides that end this one.
double Step(double distance_px, double blur_px) {
  if (distance_px > 3.5 * blur_px) return 1.0;
  return 0.5 * std::erfc(-distance_px / blur_px * 0.70710678118654752);
}

// Everything about one side that a pass keeps fixed.
struct SideModel {
  Side side, previous, next;
  GrayLine inner_gray, outer_gray;
  Parallel inner, outer;
  double dark, light;
  double blur_px;
};

SideModel MakeSideModel(const cv::Mat& gray, const Quad& quad, int side_idx, int num_cells,
                        double blur_px) {
  const auto turned = [&](int turns) {
    Quad result;
    for (int i = 0; i < kNumCorners; ++i) {
      result[static_cast<std::size_t>(i)] =
          quad[static_cast<std::size_t>((i + turns) % kNumCorners)];
    }
    return result;
  };
  const Quad own = turned(side_idx);
  const UnitSquareMap map(own);
  const double cell = 1.0 / num_cells;
  SideModel model;
  model.side = MakeSide(own);
  model.previous = MakeSide(turned(side_idx + kNumCorners - 1));
  model.next = MakeSide(turned(side_idx + 1));
  model.inner_gray = ReadLine(gray, map, 1.5 * cell);
  model.outer_gray = ReadLine(gray, map, -(kQuietZoneCells + 0.5) * cell);
  model.inner = MakeParallel(model.side, map, cell);
  model.outer = MakeParallel(model.side, map, -kQuietZoneCells * cell);
  model.dark = Mean(ReadLine(gray, map, 0.5 * cell));
  model.light = Mean(ReadLine(gray, map, -0.5 * kQuietZoneCells * cell));
  model.blur_px = blur_px;
  return model;
}

EdgeSample MakeSample(const SideModel& model, const Eigen::Vector2d& x_px, double along_px,
                      double distance_px, double gray) {
  EdgeSample sample;
  sample.s = along_px / model.side.half_length_px;
  sample.distance_px = distance_px;
  sample.gray = gray;
  for (const Side* neighbour : {&model.previous, &model.next}) {
    sample.cover *= Step(-(x_px - neighbour->middle_px).dot(neighbour->outward), model.blur_px);
  }
  sample.inner = std::max(0.0, LookUp(model.inner_gray, model.inner.u(sample.s)) - model.dark);
  sample.outer = std::min(0.0, LookUp(model.outer_gray, model.outer.u(sample.s)) - model.light);
  sample.inner_depth_px = model.inner.depth_px(sample.s);
  sample.outer_depth_px = model.outer.depth_px(sample.s);
  return sample;
}

// All pixels within the band, or every k-th row or column of them. Two sides' blur mixes near the
// corners, which are left out.
void SampleSide(const cv::Mat& gray, const SideModel& model, const Pass& pass,
                EdgeSamples* samples) {
  const Side& side = model.side;
  const double margin_px =
      std::clamp(0.24 * side.half_length_px, model.blur_px, 2.5 * model.blur_px);
  const double reach_px = side.half_length_px - margin_px;
  const int major = std::abs(side.along.x()) >= std::abs(side.along.y()) ? 0 : 1;
  const int minor = 1 - major;
  const double major_reach =
      reach_px * std::abs(side.along[major]) + pass.band_px * std::abs(side.outward[major]);
  const double minor_reach = pass.band_px / std::abs(side.outward[minor]);
  const int stride = static_cast<int>(
      std::ceil(4 * reach_px * pass.band_px / std::min(pass.max_samples, kMaxEdgeSamples)));
  const int major_size = major == 0 ? gray.cols : gray.rows;
  const int minor_size = major == 0 ? gray.rows : gray.cols;
  const int first = std::max(0, static_cast<int>(std::ceil(side.middle_px[major] - major_reach)));
  const int last =
      std::min(major_size - 1, static_cast<int>(std::floor(side.middle_px[major] + major_reach)));
  samples->count = 0;
  for (int i = first; i <= last; i += stride) {
    const double center =
        side.middle_px[minor] + (i - side.middle_px[major]) * side.along[minor] / side.along[major];
    const int begin = std::max(0, static_cast<int>(std::ceil(center - minor_reach)));
    const int end = std::min(minor_size - 1, static_cast<int>(std::floor(center + minor_reach)));
    for (int j = begin; j <= end; ++j) {
      Eigen::Vector2d x_px;
      x_px[major] = i;
      x_px[minor] = j;
      const double along_px = (x_px - side.middle_px).dot(side.along);
      if (std::abs(along_px) > reach_px || samples->count == kMaxEdgeSamples) continue;
      const double distance_px = (x_px - side.middle_px).dot(side.outward);
      const double value = major == 0 ? gray.at<std::uint8_t>(j, i) : gray.at<std::uint8_t>(i, j);
      samples->values[static_cast<std::size_t>(samples->count++)] =
          MakeSample(model, x_px, along_px, distance_px, value);
    }
  }
}

// A lens or a curved cloth bends a side by some thousandths of its length; on a short side noise
// would pass for a bend.
EdgePrior MakePrior(const SideModel& model) {
  const double contrast = model.light - model.dark;
  const double half_length = model.side.half_length_px;
  using P = EdgeParameters;
  EdgePrior prior;
  P& mean = prior.mean;
  mean[P::kBlur] = model.blur_px;
  mean[P::kDark] = model.dark;
  mean[P::kLight] = model.light;
  mean[P::kInnerGain] = mean[P::kOuterGain] = 1.0;
  P& sigma = prior.sigma;
  sigma[P::kOffset] = sigma[P::kSlope] = 1e3;
  sigma[P::kBend] = 2e-3 * half_length + 5e-4 * half_length * half_length;
  sigma[P::kBlur] = 0.5;
  sigma[P::kDark] = sigma[P::kLight] = 1e3;
  sigma[P::kDarkSlope] = sigma[P::kLightSlope] = 0.1 * contrast;
  sigma[P::kInnerGain] = sigma[P::kOuterGain] = 0.3;
  return prior;
}

std::optional<EdgeParameters> FitSide(const cv::Mat& gray, const SideModel& model, const Pass& pass,
                                      EdgeSamples* samples) {
  if (!(model.light - model.dark > kMinContrast)) return std::nullopt;
  SampleSide(gray, model, pass, samples);
  const EdgePrior prior = MakePrior(model);
  const auto fit = FitEdge(*samples, prior, pass.tolerance_px);
  if (!fit) return std::nullopt;
  const EdgeParameters& p = fit->parameters;
  if (!(p.Contrast() > kMinContrast) || fit->rms_gray > kMaxRelativeRms * p.Contrast() ||
      std::abs(p[EdgeParameters::kOffset]) + std::abs(p[EdgeParameters::kSlope]) > pass.band_px) {
    return std::nullopt;
  }
  return p;
}

struct Line {
  Eigen::Vector2d point_px, direction;
};

// The tangent of the fitted edge at its end s = -1 or 1, where the bend adds nothing.
Line TangentAtEnd(const Side& side, const EdgeParameters& p, double s) {
  using P = EdgeParameters;
  const double offset_px = p[P::kOffset] + p[P::kSlope] * s;
  const double slope = (p[P::kSlope] - 2 * p[P::kBend] * s) / side.half_length_px;
  return {side.middle_px + s * side.half_length_px * side.along + offset_px * side.outward,
          side.along + slope * side.outward};
}

std::optional<Eigen::Vector2d> Intersect(const Line& a, const Line& b) {
  Eigen::Matrix2d directions;
  directions << a.direction, -b.direction;
  if (std::abs(directions.determinant()) < 0.05) return std::nullopt;
  return a.point_px + a.direction * (directions.inverse() * (b.point_px - a.point_px)).x();
}

struct Fit {
  Quad corners_px;
  double blur_px;
};

std::optional<Fit> FitSides(const cv::Mat& gray, const Fit& start, int num_cells,
                            const Pass& pass) {
  EdgeSamples samples;
  std::array<Line, kNumCorners> starts, ends;
  double blur_sum_px = 0.0;
  for (int i = 0; i < kNumCorners; ++i) {
    const SideModel model = MakeSideModel(gray, start.corners_px, i, num_cells, start.blur_px);
    const auto parameters = FitSide(gray, model, pass, &samples);
    if (!parameters) return std::nullopt;
    starts[static_cast<std::size_t>(i)] = TangentAtEnd(model.side, *parameters, -1);
    ends[static_cast<std::size_t>(i)] = TangentAtEnd(model.side, *parameters, 1);
    blur_sum_px += (*parameters)[EdgeParameters::kBlur];
  }
  Fit fit{{}, blur_sum_px / kNumCorners};
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto corner = Intersect(starts[i], ends[(i + kNumCorners - 1) % kNumCorners]);
    if (!corner) return std::nullopt;
    fit.corners_px[i] = *corner;
  }
  return fit;
}

double MaxShiftPx(const Quad& a, const Quad& b) {
  double max_shift_px = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    max_shift_px = std::max(max_shift_px, (a[i] - b[i]).norm());
  }
  return max_shift_px;
}

double MaxAllowedShiftPx(double cell_px, const EdgeFitOptions& options) {
  return std::max(2.0, options.max_shift_in_cells * cell_px);
}

double MeanSidePx(const Quad& quad) {
  double perimeter_px = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    perimeter_px += (quad[(i + 1) % kNumCorners] - quad[i]).norm();
  }
  return perimeter_px / kNumCorners;
}

}  // namespace

std::optional<Quad> RefineCornersByEdges(const cv::Mat& gray, const Quad& corners_px, int num_cells,
                                         const EdgeFitOptions& options) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && num_cells > 0);
  const double cell_px = MeanSidePx(corners_px) / num_cells;
  const double band_px =
      std::clamp(options.band_in_cells * cell_px, options.min_band_px, options.max_band_px);
  const Pass passes[] = {{std::max(band_px, 2.0), 128, 0.05}, {band_px, 320, 5e-3}};
  Fit fit{corners_px, kFirstBlurPx};
  for (const Pass& pass : passes) {
    const auto next = FitSides(gray, fit, num_cells, pass);
    if (!next) return std::nullopt;
    fit = *next;
  }
  if (MaxShiftPx(fit.corners_px, corners_px) > MaxAllowedShiftPx(cell_px, options)) {
    return std::nullopt;
  }
  return fit.corners_px;
}

std::optional<Quad> RefineCorners(const cv::Mat& gray, const Quad& corners_px, const cv::Mat& cells,
                                  const EdgeFitOptions& options) {
  const double cell_px = MeanSidePx(corners_px) / cells.rows;
  if (cell_px < options.min_edge_cell_px) {
    const auto fitted = FitPattern(gray, corners_px, cells);
    if (fitted && MaxShiftPx(*fitted, corners_px) <= MaxAllowedShiftPx(cell_px, options)) {
      return fitted;
    }
  }
  return RefineCornersByEdges(gray, corners_px, cells.rows, options);
}

}  // namespace velamap
