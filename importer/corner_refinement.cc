#include "importer/corner_refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace velamap {
namespace {

using Corners = std::array<Eigen::Vector2d, kNumCorners>;

constexpr int kNumPasses = 2;  // the second samples along the lines of the first
constexpr int kMaxIterations = 8;
constexpr int kMaxSamplesAlong = 32;
constexpr int kMaxSamplesAcross = 13;
constexpr int kMinSamplesAlong = 4;
constexpr int kMinSamplesAcross = 7;
constexpr double kCornerMarginPx = 2.5;       // where the neighbouring side blurs into the profile
constexpr double kMinContrast = 10.0;         // grey levels
constexpr double kMaxRelativeResidual = 0.2;  // of the contrast, rms
constexpr double kNoiseOfContrast = 0.03;     // expected, for the weight of the bend's prior
constexpr double kBendSigma = 0.01;           // expected bend as a part of half the side
constexpr double kMinBlurPx = 0.3, kMaxBlurPx = 4.0;
constexpr double kMinStepPx = 1e-3;

// Parameters of one side: offset of the edge from the sampled line, px, as a function of the place
// s in [-1, 1] along it: offset + slope * s + bend * (1 - s^2), so that the ends carry no bend;
// blur, px; grey levels inside (dark) and outside (light), each linear in s.
enum Parameter {
  kOffset,
  kSlope,
  kBend,
  kBlur,
  kDark,
  kLight,
  kDarkSlope,
  kLightSlope,
  kNumParameters
};
using Parameters = Eigen::Matrix<double, kNumParameters, 1>;

struct Sample {
  double s;
  double distance_px;  // outwards from the sampled line
  double gray;
};

struct Side {
  Eigen::Vector2d middle, along, outward;  // px; unit vectors
  double half_length_px;
};

struct Samples {
  std::array<Sample, kMaxSamplesAlong * kMaxSamplesAcross> values;
  int count = 0;
};

Side MakeSide(const Corners& corners, int side_idx) {
  const Eigen::Vector2d& a = corners[static_cast<std::size_t>(side_idx)];
  const Eigen::Vector2d& b = corners[static_cast<std::size_t>((side_idx + 1) % kNumCorners)];
  const Eigen::Vector2d center = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  Side side{0.5 * (a + b), (b - a).normalized(), {}, 0.5 * (b - a).norm()};
  side.outward = {side.along.y(), -side.along.x()};
  if (side.outward.dot(side.middle - center) < 0) side.outward = -side.outward;
  return side;
}

std::optional<double> Interpolate(const cv::Mat& gray, const Eigen::Vector2d& x_px) {
  const int column = static_cast<int>(std::floor(x_px.x()));
  const int row = static_cast<int>(std::floor(x_px.y()));
  if (column < 0 || row < 0 || column + 1 >= gray.cols || row + 1 >= gray.rows) return std::nullopt;
  const double fx = x_px.x() - column, fy = x_px.y() - row;
  const std::uint8_t* upper = gray.ptr<std::uint8_t>(row) + column;
  const std::uint8_t* lower = gray.ptr<std::uint8_t>(row + 1) + column;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) +
         fy * ((1 - fx) * lower[0] + fx * lower[1]);
}

// A grid of samples along and across the side; places outside the image are left out.
Samples SampleSide(const cv::Mat& gray, const Side& side, double band_px) {
  const double margin_px = std::min(kCornerMarginPx, 0.4 * side.half_length_px);
  const double usable_px = 2 * (side.half_length_px - margin_px);
  const int num_along =
      std::clamp(static_cast<int>(usable_px) + 1, kMinSamplesAlong, kMaxSamplesAlong);
  const int num_across = std::clamp(2 * static_cast<int>(std::ceil(2 * band_px)) + 1,
                                    kMinSamplesAcross, kMaxSamplesAcross);
  Samples samples;
  for (int i = 0; i < num_along; ++i) {
    const double along_px = usable_px * (i / (num_along - 1.0) - 0.5);
    for (int j = 0; j < num_across; ++j) {
      const double distance_px = band_px * (2.0 * j / (num_across - 1.0) - 1);
      const auto value =
          Interpolate(gray, side.middle + along_px * side.along + distance_px * side.outward);
      if (!value) continue;
      samples.values[static_cast<std::size_t>(samples.count++)] = {along_px / side.half_length_px,
                                                                   distance_px, *value};
    }
  }
  return samples;
}

Parameters InitialGuess(const Samples& samples, double band_px) {
  double dark = 0, light = 0;
  int num_dark = 0, num_light = 0;
  for (int i = 0; i < samples.count; ++i) {
    const Sample& sample = samples.values[static_cast<std::size_t>(i)];
    if (sample.distance_px < -0.5 * band_px) dark += sample.gray, ++num_dark;
    if (sample.distance_px > 0.5 * band_px) light += sample.gray, ++num_light;
  }
  Parameters guess = Parameters::Zero();
  guess[kBlur] = 0.8;
  guess[kDark] = dark / std::max(num_dark, 1);
  guess[kLight] = light / std::max(num_light, 1);
  return guess;
}

// Cost and normal equations of a fit at one set of parameters.
struct NormalEquations {
  double cost = 0.0;
  Eigen::Matrix<double, kNumParameters, kNumParameters> hessian;
  Parameters gradient;
};

// Cumulative normal distribution and density, by linear interpolation to 3e-6.
class NormalTable {
 public:
  NormalTable() {
    for (int i = 0; i <= kSize; ++i) {
      const double z = i / kPerUnit - kMaxZ;
      cumulative_[static_cast<std::size_t>(i)] = 0.5 * (1 + std::erf(z / std::sqrt(2.0)));
      density_[static_cast<std::size_t>(i)] = std::exp(-0.5 * z * z) / std::sqrt(2 * CV_PI);
    }
  }

  // (cumulative, density) at z.
  std::pair<double, double> At(double z) const {
    const double position = std::clamp((z + kMaxZ) * kPerUnit, 0.0, kSize - 1e-6);
    const std::size_t i = static_cast<std::size_t>(position);
    const double f = position - static_cast<double>(i);
    return {(1 - f) * cumulative_[i] + f * cumulative_[i + 1],
            (1 - f) * density_[i] + f * density_[i + 1]};
  }

 private:
  static constexpr double kMaxZ = 6.0, kPerUnit = 128.0;
  static constexpr int kSize = static_cast<int>(2 * kMaxZ * kPerUnit);
  std::array<double, kSize + 1> cumulative_, density_;
};

// `bend_weight` is the weight of the prior on the bend.
NormalEquations Evaluate(const Samples& samples, const Parameters& p, double bend_weight) {
  static const NormalTable table;
  NormalEquations equations;
  equations.hessian.setZero();
  equations.gradient.setZero();
  for (int i = 0; i < samples.count; ++i) {
    const Sample& sample = samples.values[static_cast<std::size_t>(i)];
    const double s = sample.s;
    const double dark = p[kDark] + p[kDarkSlope] * s, light = p[kLight] + p[kLightSlope] * s;
    const double z =
        (sample.distance_px - (p[kOffset] + p[kSlope] * s + p[kBend] * (1 - s * s))) / p[kBlur];
    const auto [step, density] = table.At(z);
    const double residual = dark + (light - dark) * step - sample.gray;
    const double by_offset = -(light - dark) * density / p[kBlur];
    Parameters jacobian;
    jacobian << by_offset, by_offset * s, by_offset * (1 - s * s), by_offset * z, 1 - step, step,
        (1 - step) * s, step * s;
    equations.cost += residual * residual;
    equations.hessian.noalias() += jacobian * jacobian.transpose();
    equations.gradient += residual * jacobian;
  }
  equations.cost += bend_weight * p[kBend] * p[kBend];
  equations.hessian(kBend, kBend) += bend_weight;
  equations.gradient[kBend] += bend_weight * p[kBend];
  return equations;
}

// Levenberg-Marquardt. The bend has a weak prior: a side bends by hundredths of its length at most,
// and on short sides noise would pass for a bend.
std::optional<Parameters> FitSide(const Samples& samples, double band_px, double half_length_px) {
  if (samples.count < kMinSamplesAlong * kMinSamplesAcross) return std::nullopt;
  Parameters p = InitialGuess(samples, band_px);
  const double contrast = p[kLight] - p[kDark];
  if (!(contrast > kMinContrast)) return std::nullopt;
  const double bend_weight =
      std::pow(kNoiseOfContrast * contrast / (kBendSigma * half_length_px), 2);
  double damping = 1e-4;
  NormalEquations current = Evaluate(samples, p, bend_weight);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    auto damped = current.hessian;
    damped.diagonal() *= 1 + damping;
    const Parameters step = -damped.ldlt().solve(current.gradient);
    if (!step.allFinite()) return std::nullopt;
    Parameters candidate = p + step;
    candidate[kBlur] = std::clamp(candidate[kBlur], kMinBlurPx, kMaxBlurPx);
    NormalEquations next = Evaluate(samples, candidate, bend_weight);
    if (!(next.cost < current.cost)) {
      damping *= 10;
      continue;
    }
    p = candidate;
    current = std::move(next);
    damping *= 0.1;
    if (step.head<3>().norm() < kMinStepPx) break;
  }
  const double fitted_contrast = p[kLight] - p[kDark];
  const double rms = std::sqrt(current.cost / samples.count);
  if (!(fitted_contrast > kMinContrast) || rms > kMaxRelativeResidual * fitted_contrast ||
      std::abs(p[kOffset]) + std::abs(p[kSlope]) > band_px) {
    return std::nullopt;
  }
  return p;
}

struct Line {
  Eigen::Vector2d point, direction;
};

std::optional<Eigen::Vector2d> Intersect(const Line& a, const Line& b) {
  Eigen::Matrix2d directions;
  directions << a.direction, -b.direction;
  const double determinant = directions.determinant();
  if (std::abs(determinant) < 0.05) return std::nullopt;
  return a.point + a.direction * (directions.inverse() * (b.point - a.point)).x();
}

// The tangent of the fitted edge at its end s = -1 or 1.
Line TangentAtEnd(const Side& side, const Parameters& p, double s) {
  const double offset_px = p[kOffset] + p[kSlope] * s;
  const double slope = (p[kSlope] - 2 * p[kBend] * s) / side.half_length_px;
  return {side.middle + s * side.half_length_px * side.along + offset_px * side.outward,
          (side.along + slope * side.outward).normalized()};
}

std::optional<Corners> FitOnce(const cv::Mat& gray, const Corners& corners, double band_px) {
  std::array<Line, kNumCorners> starts, ends;
  for (int i = 0; i < kNumCorners; ++i) {
    const Side side = MakeSide(corners, i);
    if (side.half_length_px < 2) return std::nullopt;
    const auto fit = FitSide(SampleSide(gray, side, band_px), band_px, side.half_length_px);
    if (!fit) return std::nullopt;
    starts[static_cast<std::size_t>(i)] = TangentAtEnd(side, *fit, -1);
    ends[static_cast<std::size_t>(i)] = TangentAtEnd(side, *fit, 1);
  }
  Corners refined;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto corner = Intersect(starts[i], ends[(i + kNumCorners - 1) % kNumCorners]);
    if (!corner) return std::nullopt;
    refined[i] = *corner;
  }
  return refined;
}

}  // namespace

std::optional<Corners> RefineCornersByEdges(const cv::Mat& gray, const Corners& corners_px,
                                            int num_cells, const EdgeFitOptions& options) {
  double perimeter_px = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    perimeter_px += (corners_px[(i + 1) % kNumCorners] - corners_px[i]).norm();
  }
  const double cell_px = perimeter_px / kNumCorners / num_cells;
  const double band_px =
      std::clamp(options.band_in_cells * cell_px, options.min_band_px, options.max_band_px);
  const double max_shift_px = std::max(1.5, options.max_shift_in_cells * cell_px);
  Corners corners = corners_px;
  for (int pass = 0; pass < kNumPasses; ++pass) {
    const auto refined = FitOnce(gray, corners, band_px);
    if (!refined) return std::nullopt;
    corners = *refined;
  }
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    if (!((corners[i] - corners_px[i]).norm() <= max_shift_px)) return std::nullopt;
  }
  return corners;
}

}  // namespace velamap
