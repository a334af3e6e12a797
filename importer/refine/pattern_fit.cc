#include "importer/refine/pattern_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "importer/base/error.h"
#include "importer/detect/interpolate.h"
#include "importer/geometry/least_squares.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/refine/fit_equations.h"
#include "importer/refine/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

constexpr double kMinContrast = 12.0;    // grey levels
constexpr double kMaxRelativeRms = 0.2;  // of the residuals, relative to the contrast
constexpr double kPixelNoise = 3.0;      // grey levels; sets the weight of the priors
constexpr double kMinBlurPx = 0.3;
constexpr double kMaxBlurPx = 4.0;
constexpr double kBendOfDiagonal =
    0.003;  // usual for cloth; the label of a can has ten times as much
constexpr int kFirstPixels = 200;
constexpr int kPixels = 1000;

using Equations = FitEquations<P::kCount>;

struct Problem {
  const cv::Mat* gray;
  cv::Rect box;
  PatternModel model;
  P::Vector mean, weight;  // priors
};

// Pixels of a marker and around it, in groups.
struct Pixels {
  struct Group {
    Floats x, y;  // relative to center_px of the model
    Floats gray;
  };
  std::vector<Group> groups;
  int count = 0;  // the last group may be incomplete
};

// Completes the last group with copies of its first pixel.
inline void FillUp(Pixels* pixels) {
  for (int lane = pixels->count % kLanes; lane > 0 && lane < kLanes; ++lane) {
    Pixels::Group& last = pixels->groups.back();
    last.x[lane] = last.x[0];
    last.y[lane] = last.y[0];
    last.gray[lane] = last.gray[0];
  }
}

// Every k-th pixel that the model covers with these parameters, where k leaves about `max_pixels`.
VELAMAP_CLONE_FOR_AVX2 Pixels ChoosePixels(const Problem& problem, const P::Vector& parameters,
                                           int max_pixels) {
  const PatternPicture picture(problem.model, parameters);
  const cv::Rect& box = problem.box;
  const Eigen::Vector2d& center = problem.model.center_px;
  const double area_px = 0.8 * problem.model.diagonal_px * problem.model.diagonal_px;
  const int stride = static_cast<int>(std::ceil(area_px / max_pixels));
  Pixels pixels;
  pixels.groups.reserve(
      static_cast<std::size_t>(box.height * (box.width / stride + 1) / kLanes + 1));
  for (int row = box.y; row < box.y + box.height; ++row) {
    const std::uint8_t* values = problem.gray->ptr<std::uint8_t>(row);
    const Floats y = AllLanes(row - center.y());
    // Odd rows are shifted, so that all columns are used. The choice of pixels does not depend on
    // where the box begins.
    const int shift = row * ((stride + 1) / 2) % stride;
    const int first = box.x + (shift + stride - box.x % stride) % stride;
    for (int begin = first; begin < box.x + box.width; begin += kLanes * stride) {
      const Floats x =
          static_cast<float>(begin - center.x()) + static_cast<float>(stride) * LaneIndex();
      const Ints covered = picture.Covers(x, y);
      for (int lane = 0; lane < kLanes; ++lane) {
        const int column = begin + lane * stride;
        if (!covered[lane] || column >= box.x + box.width) continue;
        const int place = pixels.count++ % kLanes;
        if (place == 0) pixels.groups.emplace_back();
        Pixels::Group& group = pixels.groups.back();
        group.x[place] = x[lane];
        group.y[place] = y[lane];
        group.gray[place] = values[column];
      }
    }
  }
  FillUp(&pixels);
  return pixels;
}

VELAMAP_CLONE_FOR_AVX2 void SumUp(const Problem& problem, const Pixels& pixels,
                                  const P::Vector& parameters, bool with_hessian,
                                  Equations* equations) {
  const PatternPicture picture(problem.model, parameters);
  equations->Clear(with_hessian);
  PatternPixels modelled;
  int left = pixels.count;
  for (const Pixels::Group& group : pixels.groups) {
    picture.At(group.x, group.y, &modelled);
    equations->Add(&modelled.jacobian, modelled.gray - group.gray, left);
    left -= kLanes;
  }
  equations->Finish(parameters - problem.mean, problem.weight);
}

// Initial parameters: the given corners, and the mean grey levels of dark and light cells.
std::optional<P::Vector> Start(const cv::Mat& cells, const QuadCorners& corners, Problem* problem) {
  P::Vector p = P::Vector::Zero();
  for (int i = 0; i < kNumCorners; ++i) {
    p.segment<2>(2 * i) = corners[static_cast<std::size_t>(i)];
  }
  p[P::kBlurU] = p[P::kBlurV] = p[P::kSurround] = p[P::kInnerLight] = 1.0;
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  const UnitSquareMap map(corners);
  const int n = problem->model.num_cells;
  for (int j = -1; j <= n; ++j) {
    for (int i = -1; i <= n; ++i) {
      const bool inside = i >= 0 && j >= 0 && i < n && j < n;
      const int is_light = !inside || cells.at<std::uint8_t>(j, i) != 0;
      sum[is_light] += InterpolateGray(*problem->gray, map.ToImage((i + 0.5) / n, (j + 0.5) / n));
      ++count[is_light];
    }
  }
  p[P::kDark] = sum[0] / count[0];
  p[P::kLight] = sum[1] / count[1];
  if (!(p[P::kLight] - p[P::kDark] > kMinContrast / 2)) return std::nullopt;
  problem->mean = p;
  P::Vector sigma;
  sigma << P::Vector::Constant(1e3).head<8>(), 0.7, 0.7, 1e3, 1e3, 0.15, 0.15, 0.3, 0.1,
      Eigen::Vector4d::Constant(kBendOfDiagonal * problem->model.diagonal_px);
  problem->weight = (kPixelNoise * sigma.cwiseInverse()).cwiseAbs2();
  return p;
}

// The best parameters so far, and the normal equations there.
struct Minimum {
  P::Vector parameters;
  Equations equations;
};

// The fit to some pixels as a problem of MinimizeSquares().
struct PatternProblem {
  using Parameters = P::Vector;
  using Equations = FitEquations<P::kCount>;
  using Step = P::Vector;

  const Problem& problem;
  const Pixels& pixels;

  void Evaluate(const P::Vector& parameters, bool with_hessian, Equations* equations) const {
    SumUp(problem, pixels, parameters, with_hessian, equations);
  }
  P::Vector Plus(const P::Vector& parameters, const P::Vector& step) const {
    return parameters + step;
  }
  // How far a corner moves, px.
  double StepSize(const P::Vector& step, const Equations&) const {
    return step.head<8>().cwiseAbs().maxCoeff();
  }
  P::Vector LimitStep(const P::Vector& parameters, P::Vector step) const {
    for (const int index : {P::kBlurU, P::kBlurV}) {
      LimitParameter(kMinBlurPx, kMaxBlurPx, parameters[index], &step[index]);
    }
    return step;
  }
  void Predict(const P::Vector& step, Equations* equations) const { equations->Predict(step); }
};

// Fits about `max_pixels` pixels until a step moves no corner further than `tolerance_px`. False
// for too few pixels or a singular system.
bool Minimize(const Problem& problem, int max_pixels, double tolerance_px, Minimum* minimum) {
  const Pixels pixels = ChoosePixels(problem, minimum->parameters, max_pixels);
  if (pixels.count <= P::kCount) return false;
  LeastSquaresOptions options;
  options.max_iterations = 10;
  options.initial_damping = 1e-3;
  options.min_step = tolerance_px;
  options.min_step_for_new_hessian = 0.1;
  return MinimizeSquares(options, PatternProblem{problem, pixels}, &minimum->parameters,
                         &minimum->equations) != Convergence::kFailed;
}

// A coarse fit to some pixels, then a fine one to more pixels, with the surroundings read again. A
// wide blur needs another fit, because grey levels, blur and surroundings then depend on each
// other. False if the image does not show such a marker.
bool MinimizeInPasses(const cv::Mat& cells, Problem* problem, Minimum* minimum) {
  constexpr double kWideBlur = 0.3;  // in cells
  struct Pass {
    int max_pixels;
    double tolerance_px, min_blur_cells;
  };
  for (const Pass& pass :
       {Pass{kFirstPixels, 0.1, 0.0}, {kPixels, 0.02, 0.0}, {kPixels, 0.02, kWideBlur}}) {
    const double blur_cells =
        FillLightness(*problem->gray, cells, minimum->parameters, &problem->model);
    if (blur_cells < pass.min_blur_cells) break;
    if (!Minimize(*problem, pass.max_pixels, pass.tolerance_px, minimum)) return false;
  }
  const double contrast = minimum->parameters[P::kLight] - minimum->parameters[P::kDark];
  return contrast > kMinContrast && minimum->equations.Rms() < kMaxRelativeRms * contrast;
}

// `inverse` of the Hessian.
VELAMAP_CLONE_FOR_AVX2 ResidualNoise NoiseOf(const Equations& equations, const P::Matrix& inverse) {
  return equations.Noise(inverse, [](const Equations::Jacobian& jacobian) {
    // The sum over all corners is the slope of the grey levels.
    Floats slope_x{}, slope_y{};
    for (std::size_t i = 0; i < 2 * kNumCorners; i += 2) {
      slope_x += jacobian[i];
      slope_y += jacobian[i + 1];
    }
    return slope_x * slope_x + slope_y * slope_y;
  });
}

// The priors stabilise weak parameters but are not observations, so that their error does not
// count.
std::optional<RefinedCorners> WithUncertainty(const Problem& problem, const Minimum& minimum) {
  const Eigen::LLT<P::Matrix> factors(minimum.equations.hessian());
  if (factors.info() != Eigen::Success) return std::nullopt;
  const P::Matrix inverse = factors.solve(P::Matrix::Identity());
  if (!inverse.allFinite()) return std::nullopt;
  // The diagonal of inverse * (hessian - weight) * inverse.
  const P::Vector variances = inverse.diagonal() - inverse.cwiseAbs2().lazyProduct(problem.weight);
  const ResidualNoise noise = NoiseOf(minimum.equations, inverse);
  RefinedCorners refined{CornersOf(minimum.parameters), {}};
  for (int i = 0; i < kNumCorners; ++i) {
    refined.sigma_px[static_cast<std::size_t>(i)] =
        std::sqrt(0.5 * variances.segment<2>(2 * i).sum() * noise.VarianceGray());
  }
  return refined;
}

}  // namespace

std::optional<RefinedCorners> FitPattern(const cv::Mat& gray, const QuadCorners& corners_px,
                                         const cv::Mat& cells) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && cells.type() == CV_8UC1 && cells.rows == cells.cols);
  Problem problem;
  problem.gray = &gray;
  problem.model.num_cells = cells.rows;
  if (problem.model.num_cells + 2 * kRing > kMaxRingedCells) return std::nullopt;
  const UnitSquareMap map(corners_px);
  const double reach = 1.0 / problem.model.num_cells;
  Eigen::Vector2d low = map.ToImage(-reach, -reach), high = low;
  for (const auto& [u, v] : {std::pair(1 + reach, -reach), std::pair(1 + reach, 1 + reach),
                             std::pair(-reach, 1 + reach)}) {
    low = low.cwiseMin(map.ToImage(u, v));
    high = high.cwiseMax(map.ToImage(u, v));
  }
  if (!low.allFinite() || !high.allFinite() || low.minCoeff() < 0 || high.x() > gray.cols - 1 ||
      high.y() > gray.rows - 1) {
    return std::nullopt;
  }
  problem.box = cv::Rect(cv::Point(static_cast<int>(low.x()), static_cast<int>(low.y())),
                         cv::Point(static_cast<int>(high.x()) + 1, static_cast<int>(high.y()) + 1));
  problem.model.center_px = map.ToImage(0.5, 0.5);
  problem.model.diagonal_px =
      0.5 * ((corners_px[2] - corners_px[0]).norm() + (corners_px[3] - corners_px[1]).norm());
  const auto start = Start(cells, corners_px, &problem);
  if (!start) return std::nullopt;
  Minimum minimum{*start, {}};
  if (!MinimizeInPasses(cells, &problem, &minimum)) return std::nullopt;
  return WithUncertainty(problem, minimum);
}

}  // namespace velamap
