#include "importer/refine/pattern_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "importer/base/error.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/refine/least_squares.h"
#include "importer/refine/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

constexpr double kMinContrast = 12.0;    // grey levels
constexpr double kMaxRelativeRms = 0.2;  // of the residuals, by contrast
constexpr double kPixelNoise = 3.0;      // grey levels, against which the priors weigh
constexpr double kMinBlurPx = 0.3;
constexpr double kMaxBlurPx = 4.0;
constexpr double kBendOfDiagonal = 0.003;  // what cloth usually has; a can's label has ten times
constexpr double kMarginSigma = 0.5;       // cells
constexpr double kMinMargin = 0.1, kMaxMargin = 1.5;
constexpr int kFirstPixels = 200;
constexpr int kPixels = 1000;

using Equations = FitEquations<P::kCount>;

struct Problem {
  GrayPatch patch;
  cv::Rect box;
  PatternModel model;
  P::Vector mean, weight;  // priors
};

// Pixels of a marker and around it, in groups.
struct Pixels {
  struct Group {
    Floats x, y;  // less the model's center_px
    Floats gray;
  };
  std::vector<Group> groups;
  int count = 0;  // the last group may have less
};

// What is missing of the last group becomes a copy of its first pixel.
inline void FillUp(Pixels* pixels) {
  for (int lane = pixels->count % kLanes; lane > 0 && lane < kLanes; ++lane) {
    Pixels::Group& last = pixels->groups.back();
    last.x[lane] = last.x[0];
    last.y[lane] = last.y[0];
    last.gray[lane] = last.gray[0];
  }
}

// Every k-th pixel that the model covers with these parameters, so many that about `max_pixels` are
// used.
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
    const float* values = problem.patch.values.ptr<float>(row - problem.patch.origin_px.y) -
                          problem.patch.origin_px.x;
    const Floats y = AllLanes(row - center.y());
    // Odd rows are shifted, so that every column has its share. Which pixels are used does not
    // depend on where the box begins.
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

VELAMAP_CLONE_FOR_AVX2 void Evaluate(const Problem& problem, const Pixels& pixels,
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

// Widths of the quiet zone in cells, as in PatternParameters: where, on the way out from a side,
// the light is halfway between the marker's and what is beyond. 1 where the two are alike.
Eigen::Vector4d FindMargins(const Problem& problem, const QuadCorners& corners, double dark,
                            double light) {
  constexpr int kPlaces = 9, kSteps = 18;
  constexpr double kStep = 0.1;  // cells
  const UnitSquareMap map(corners);
  const int n = problem.model.num_cells;
  Eigen::Vector4d margins;
  for (int side = 0; side < 4; ++side) {
    std::array<double, kSteps> profile{};
    for (int k = 0; k < kSteps; ++k) {
      const double out = -(k + 1) * kStep / n;
      for (int i = 0; i < kPlaces; ++i) {
        const double along = (i + 0.5) / kPlaces;
        const double across = side % 2 == 0 ? out : 1 - out;
        const Eigen::Vector2d uv =
            side < 2 ? Eigen::Vector2d(across, along) : Eigen::Vector2d(along, across);
        profile[static_cast<std::size_t>(k)] += problem.model.tone->Decode(InterpolatePatch(
                                                    problem.patch, map.ToImage(uv.x(), uv.y()))) /
                                                kPlaces;
      }
    }
    const double beyond = (profile[kSteps - 1] + profile[kSteps - 2] + profile[kSteps - 3]) / 3;
    margins[side] = 1.0;
    if (std::abs(beyond - light) < 0.1 * (light - dark)) continue;
    const double middle = 0.5 * (beyond + light);
    int k = kSteps - 1;
    while (k > 0 && (profile[static_cast<std::size_t>(k)] > middle) == (beyond > middle)) --k;
    margins[side] = std::clamp((k + 1.5) * kStep, kMinMargin, kMaxMargin);
  }
  return margins;
}

// Levels that explain the pixels best while the corners stay.
std::optional<P::Vector> Start(const cv::Mat& cells, const QuadCorners& corners, Problem* problem) {
  P::Vector p = P::Vector::Zero();
  for (int i = 0; i < kNumCorners; ++i) {
    p.segment<2>(2 * i) = corners[static_cast<std::size_t>(i)];
  }
  p[P::kBlurU] = p[P::kBlurV] = p[P::kSurround] = p[P::kInnerLight] = 1.0;
  p.segment<4>(P::kMargin).setOnes();
  double light = 0.0;
  int num_light = 0;
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  const UnitSquareMap map(corners);
  const int n = problem->model.num_cells;
  for (int j = -1; j <= n; ++j) {
    for (int i = -1; i <= n; ++i) {
      const bool inside = i >= 0 && j >= 0 && i < n && j < n;
      const int is_light = !inside || cells.at<std::uint8_t>(j, i) != 0;
      const double before = sum[1];
      const double reach = inside ? 0.5 : 0.7;
      const auto place = [&](int k) {
        return k < 0 ? -(1 - reach) / n : k == n ? 1 + (1 - reach) / n : (k + 0.5) / n;
      };
      sum[is_light] += problem->model.tone->Decode(
          InterpolatePatch(problem->patch, map.ToImage(place(i), place(j))));
      ++count[is_light];
      if (inside && is_light) {
        light += sum[1] - before;
        ++num_light;
      }
    }
  }
  p[P::kDark] = sum[0] / count[0];
  light = num_light > 0 ? light / num_light : sum[1] / count[1];
  p[P::kLight] = num_light > 0 ? light : sum[1] / count[1];
  if (!(p[P::kLight] - p[P::kDark] > 0.02 * p[P::kLight])) return std::nullopt;
  p.segment<4>(P::kMargin) = FindMargins(*problem, corners, p[P::kDark], light);
  problem->mean = p;
  problem->mean.segment<4>(P::kMargin).setOnes();
  P::Vector sigma;
  sigma << P::Vector::Constant(1e3).head<8>(), 0.7, 0.7, 1e3, 1e3, 0.15, 0.15, 0.3, 0.02,
      Eigen::Vector4d::Constant(kBendOfDiagonal * problem->model.diagonal_px),
      Eigen::Vector4d::Constant(kMarginSigma);
  problem->weight = (kPixelNoise * sigma.cwiseInverse()).cwiseAbs2();
  return p;
}

// The best parameters so far, and how the model meets the pixels there.
struct Minimum {
  P::Vector parameters;
  Equations equations;
};

void LimitBlur(P::Vector* parameters) {
  for (const int index : {P::kBlurU, P::kBlurV}) {
    (*parameters)[index] = std::clamp((*parameters)[index], kMinBlurPx, kMaxBlurPx);
  }
  auto margin = parameters->segment<4>(P::kMargin);
  margin = margin.cwiseMax(kMinMargin).cwiseMin(kMaxMargin);
}

// Over about `max_pixels` pixels, until a step moves no corner further than `tolerance_px`. False
// for too few pixels or a singular system.
bool Minimize(const Problem& problem, int max_pixels, double tolerance_px, Minimum* minimum) {
  const Pixels pixels = ChoosePixels(problem, minimum->parameters, max_pixels);
  LeastSquaresOptions options;
  options.tolerance_px = tolerance_px;
  options.new_hessian_px = 0.1;
  return MinimizeSquares(
      options,
      [&](const P::Vector& parameters, bool with_hessian, Equations* equations) {
        Evaluate(problem, pixels, parameters, with_hessian, equations);
      },
      [](const P::Vector& step) { return step.head<8>().cwiseAbs().maxCoeff(); }, LimitBlur,
      &minimum->parameters, &minimum->equations);
}

// A quick fit on some pixels, then an exact one on more from there, with the surroundings read
// anew; and once more where the blur is wide, because then grey levels, blur and surroundings are
// only found together. False if there is no marker like this.
bool MinimizeInPasses(const cv::Mat& cells, Problem* problem, Minimum* minimum) {
  constexpr double kWideBlur = 0.3;  // in cells
  struct Pass {
    int max_pixels;
    double tolerance_px, min_blur_cells;
  };
  for (const Pass& pass :
       {Pass{kFirstPixels, 0.1, 0.0}, {kPixels, 0.02, 0.0}, {kPixels, 0.02, kWideBlur}}) {
    const double blur_cells =
        FillLightness(problem->patch, cells, minimum->parameters, &problem->model);
    if (blur_cells < pass.min_blur_cells) break;
    if (!Minimize(*problem, pass.max_pixels, pass.tolerance_px, minimum)) return false;
  }
  const ToneCurve& tone = *problem->model.tone;
  const double contrast =
      tone.Encode(minimum->parameters[P::kLight]) - tone.Encode(minimum->parameters[P::kDark]);
  return contrast > kMinContrast && minimum->equations.Rms() < kMaxRelativeRms * contrast;
}

// `inverse` of the Hessian.
VELAMAP_CLONE_FOR_AVX2 ResidualNoise NoiseOf(const Equations& equations, const P::Matrix& inverse) {
  return equations.Noise(inverse, [](const Equations::Jacobian& jacobian) {
    // All corners move: the slope of the grey values.
    Floats slope_x{}, slope_y{};
    for (std::size_t i = 0; i < 2 * kNumCorners; i += 2) {
      slope_x += jacobian[i];
      slope_y += jacobian[i + 1];
    }
    return slope_x * slope_x + slope_y * slope_y;
  });
}

// The priors hold weak parameters but are no observations: their own error does not count.
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

// The problem around `corners_px`; nothing where the marker leaves the image.
std::optional<Problem> MakeProblem(const cv::Mat& gray, const QuadCorners& corners_px,
                                   const cv::Mat& cells, const ResponseModel& response) {
  Problem problem;
  problem.model.tone = &response.tone;
  problem.model.spread_cells = response.spread_sides * cells.rows;
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
  // Where the surroundings are read, too.
  const cv::Point beyond(static_cast<int>(0.2 * problem.box.width) + 3,
                         static_cast<int>(0.2 * problem.box.height) + 3);
  problem.patch = CutPatch(gray, cv::Rect(problem.box.tl() - beyond, problem.box.br() + beyond),
                           response.unsharpening);
  problem.model.center_px = map.ToImage(0.5, 0.5);
  problem.model.diagonal_px =
      0.5 * ((corners_px[2] - corners_px[0]).norm() + (corners_px[3] - corners_px[1]).norm());
  return problem;
}

}  // namespace

std::optional<RefinedCorners> FitPattern(const cv::Mat& gray, const QuadCorners& corners_px,
                                         const cv::Mat& cells, const ResponseModel& response) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && cells.type() == CV_8UC1 && cells.rows == cells.cols);
  std::optional<Problem> problem = MakeProblem(gray, corners_px, cells, response);
  if (!problem) return std::nullopt;
  const auto start = Start(cells, corners_px, &*problem);
  if (!start) return std::nullopt;
  Minimum minimum{*start, {}};
  if (!MinimizeInPasses(cells, &*problem, &minimum)) return std::nullopt;
  return WithUncertainty(*problem, minimum);
}

class PatternSample::Impl {
 public:
  Problem problem;
  Minimum minimum;
  cv::Mat cells;
  cv::Mat gray;
  cv::Rect patch_box;
  ResponseModel response;
  std::vector<Pixels::Group> groups;  // of all covered pixels, by rows
  std::vector<cv::Point> places;      // in the box
};

PatternSample::PatternSample(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PatternSample::~PatternSample() = default;
PatternSample::PatternSample(PatternSample&&) noexcept = default;
PatternSample& PatternSample::operator=(PatternSample&&) noexcept = default;
PatternSample PatternSample::Clone() const {
  auto copy = std::make_unique<Impl>(*impl_);
  copy->problem.model.tone = &copy->response.tone;
  return PatternSample(std::move(copy));
}
int PatternSample::NumPixels() const { return static_cast<int>(impl_->places.size()); }

std::optional<PatternSample> PatternSample::Make(const cv::Mat& gray, const QuadCorners& corners_px,
                                                 const cv::Mat& cells,
                                                 const ResponseModel& response) {
  auto impl = std::make_unique<Impl>();
  impl->response = response;
  impl->cells = cells;
  impl->gray = gray;
  auto problem = MakeProblem(gray, corners_px, cells, impl->response);
  if (!problem) return std::nullopt;
  impl->problem = *problem;
  impl->patch_box = cv::Rect(problem->patch.origin_px, problem->patch.values.size());
  const auto start = Start(cells, corners_px, &impl->problem);
  if (!start) return std::nullopt;
  impl->minimum = {*start, {}};
  if (!MinimizeInPasses(cells, &impl->problem, &impl->minimum)) return std::nullopt;
  const PatternPicture picture(impl->problem.model, impl->minimum.parameters);
  const Eigen::Vector2d& center = impl->problem.model.center_px;
  const cv::Rect& box = impl->problem.box;
  for (int row = 0; row < box.height; ++row) {
    for (int column = 0; column < box.width; ++column) {
      const float x = static_cast<float>(box.x + column - center.x());
      const float y = static_cast<float>(box.y + row - center.y());
      if (!picture.Covers(AllLanes(x), AllLanes(y))[0]) continue;
      const std::size_t lane = impl->places.size() % kLanes;
      if (lane == 0) {
        impl->groups.emplace_back();
        impl->groups.back().x = AllLanes(x);
        impl->groups.back().y = AllLanes(y);
      }
      impl->groups.back().x[lane] = x;
      impl->groups.back().y[lane] = y;
      impl->places.emplace_back(column, row);
    }
  }
  return PatternSample(std::move(impl));
}

bool PatternSample::Refit(const ResponseModel& response) {
  Impl& impl = *impl_;
  const ToneCurve before = impl.response.tone;
  impl.response = response;
  impl.problem.model.tone = &impl.response.tone;
  impl.problem.model.spread_cells = response.spread_sides * impl.cells.rows;
  impl.problem.patch = CutPatch(impl.gray, impl.patch_box, response.unsharpening);
  P::Vector& p = impl.minimum.parameters;
  for (const int index : {P::kDark, P::kLight}) {
    p[index] = impl.response.tone.Decode(before.Encode(p[index]));
  }
  FillLightness(impl.problem.patch, impl.cells, p, &impl.problem.model);
  return Minimize(impl.problem, kPixels, 0.003, &impl.minimum);
}

std::vector<float> PatternSample::Residuals(const CameraResponse& camera) const {
  const Impl& impl = *impl_;
  const PatternPicture picture(impl.problem.model, impl.minimum.parameters);
  cv::Mat gray = cv::Mat::zeros(impl.problem.box.size(), CV_32F);
  PatternPixels modelled;
  const cv::Point shift = impl.problem.box.tl() - impl.problem.patch.origin_px;
  for (std::size_t i = 0; i < impl.places.size(); ++i) {
    const std::size_t lane = i % kLanes;
    if (lane == 0) {
      const Pixels::Group& group = impl.groups[i / kLanes];
      picture.At(group.x, group.y, &modelled);
    }
    gray.at<float>(impl.places[i]) =
        modelled.gray[lane] - impl.problem.patch.values.at<float>(impl.places[i] + shift);
  }
  if (camera.sharpening != 0) {
    cv::Mat blurred;
    cv::GaussianBlur(gray, blurred, {0, 0}, camera.sharpening_radius_px,
                     camera.sharpening_radius_px, cv::BORDER_CONSTANT);
    gray = (1 + camera.sharpening) * gray - camera.sharpening * blurred;
  }
  std::vector<float> residuals;
  residuals.reserve(impl.places.size());
  for (const cv::Point& place : impl.places) residuals.push_back(gray.at<float>(place));
  return residuals;
}

}  // namespace velamap
