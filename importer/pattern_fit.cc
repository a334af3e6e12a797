#include "importer/pattern_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Cholesky>

#include "importer/error.h"
#include "importer/interpolate.h"
#include "importer/pattern_model.h"
#include "importer/unit_square_map.h"

namespace velamap {
namespace {

using Quad = std::array<Eigen::Vector2d, kNumCorners>;
using P = PatternParameters;

constexpr double kMinContrast = 12.0;    // grey levels
constexpr double kMaxRelativeRms = 0.2;  // of the residuals, by contrast
constexpr double kPixelNoise = 3.0;      // grey levels, against which the priors weigh
constexpr double kMinBlurPx = 0.3;
constexpr double kMaxBlurPx = 4.0;
constexpr double kBendOfDiagonal = 0.003;  // what cloth usually has; a can's label has ten times
constexpr int kMaxIterations = 10;
constexpr int kFirstPixels = 200;
constexpr int kPixels = 1000;

struct Problem {
  const cv::Mat* gray;
  cv::Rect box;
  PatternModel model;
  P::Vector mean, weight;  // priors
};

// The pixels of one evaluation of the model, what it leaves of them, and the normal equations.
class Evaluation {
 public:
  // Every k-th pixel, so many that about `max_pixels` are used.
  void Run(const Problem& problem, const P::Vector& parameters, int max_pixels) {
    Evaluate(problem, parameters, max_pixels);
    hessian_ = problem.weight.asDiagonal();
    const P::Vector departure = parameters - problem.mean;
    gradient_ = problem.weight.cwiseProduct(departure);
    prior_cost_ = departure.cwiseAbs2().dot(problem.weight);
    SumUp();
  }

  const P::Matrix& hessian() const { return hessian_; }
  const P::Vector& gradient() const { return gradient_; }
  int num_pixels() const { return num_pixels_; }
  double Rms() const { return std::sqrt(squared_residuals_ / num_pixels_); }
  double Cost() const { return (squared_residuals_ + prior_cost_) / num_pixels_; }

  // `inverse` of the Hessian.
  ResidualNoise Noise(const P::Matrix& inverse) const {
    const Eigen::Matrix<float, P::kCount, P::kCount> covariance = inverse.cast<float>();
    ResidualNoise noise;
    Block by_covariance;
    for (int begin = 0; begin < num_pixels_; begin += kBlock) {
      const auto jacobians = jacobians_.middleCols<kBlock>(begin);
      by_covariance.noalias() = covariance * jacobians;
      for (int i = 0; i < std::min(kBlock, num_pixels_ - begin); ++i) {
        // All corners move: the slope of the grey values.
        Eigen::Vector2f slope = Eigen::Vector2f::Zero();
        for (int c = 0; c < kNumCorners; ++c) slope += jacobians.col(i).segment<2>(2 * c);
        noise.Add(slope.squaredNorm(), residuals_[begin + i],
                  jacobians.col(i).dot(by_covariance.col(i)));
      }
    }
    return noise;
  }

 private:
  // Sums over many pixels at a time, because the product of matrices is fast.
  static constexpr int kBlock = 48;
  using Block = Eigen::Matrix<float, P::kCount, kBlock>;

  void Evaluate(const Problem& problem, const P::Vector& parameters, int max_pixels) {
    const PatternPicture picture(problem.model, parameters);
    const cv::Rect& box = problem.box;
    const double area_px = 0.8 * problem.model.diagonal_px * problem.model.diagonal_px;
    const int stride = static_cast<int>(std::ceil(area_px / max_pixels));
    Reserve(box.height * (box.width / stride + 1));
    PatternPixel pixel;
    num_pixels_ = 0;
    for (int row = box.y; row < box.y + box.height; ++row) {
      const std::uint8_t* pixels = problem.gray->ptr<std::uint8_t>(row);
      // Odd rows are shifted, so that every column has its share.
      const int first = box.x + (row * ((stride + 1) / 2)) % stride;
      for (int column = first; column < box.x + box.width; column += stride) {
        if (!picture.At(Eigen::Vector2d(column, row), &pixel)) continue;
        jacobians_.col(num_pixels_) = pixel.jacobian;
        residuals_[num_pixels_++] = pixel.gray - pixels[column];
      }
    }
  }

  void Reserve(int max_pixels) {
    const int size = (max_pixels + kBlock - 1) / kBlock * kBlock;
    if (residuals_.size() >= size) return;
    jacobians_.resize(P::kCount, size);
    residuals_.resize(size);
  }

  void SumUp() {
    squared_residuals_ = 0.0;
    const int padding = (kBlock - num_pixels_ % kBlock) % kBlock;
    jacobians_.middleCols(num_pixels_, padding).setZero();
    residuals_.segment(num_pixels_, padding).setZero();
    for (int begin = 0; begin < num_pixels_; begin += kBlock) {
      const auto jacobians = jacobians_.middleCols<kBlock>(begin);
      const auto residuals = residuals_.segment<kBlock>(begin);
      hessian_ += (jacobians * jacobians.transpose()).cast<double>();
      gradient_ += (jacobians * residuals.cast<float>()).cast<double>();
      squared_residuals_ += residuals.squaredNorm();
    }
  }

  Eigen::Matrix<float, P::kCount, Eigen::Dynamic> jacobians_;
  Eigen::VectorXd residuals_;
  int num_pixels_ = 0;
  P::Matrix hessian_;
  P::Vector gradient_;
  double squared_residuals_ = 0.0;
  double prior_cost_ = 0.0;  // of the priors
};

// Levels that explain the pixels best while the corners stay.
std::optional<P::Vector> Start(const cv::Mat& cells, const Quad& corners, Problem* problem) {
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

// The best parameters so far, how the model meets the pixels there, and room for a trial.
struct Minimum {
  P::Vector parameters;
  Evaluation at_parameters, trial;
};

// Levenberg-Marquardt over about `max_pixels` pixels until a step moves no corner further than
// `tolerance_px`. False for too few pixels or a singular system.
bool Minimize(const Problem& problem, int max_pixels, double tolerance_px, Minimum* minimum) {
  Evaluation& best = minimum->at_parameters;
  best.Run(problem, minimum->parameters, max_pixels);
  double damping = 1e-3;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (best.num_pixels() <= P::kCount) return false;
    P::Matrix damped = best.hessian();
    damped.diagonal() *= 1 + damping;
    const P::Vector step = -damped.selfadjointView<Eigen::Lower>().ldlt().solve(best.gradient());
    if (!step.allFinite()) return false;
    const double moved_px = step.head<8>().cwiseAbs().maxCoeff();
    P::Vector candidate = minimum->parameters + step;
    candidate[P::kBlurU] = std::clamp(candidate[P::kBlurU], kMinBlurPx, kMaxBlurPx);
    candidate[P::kBlurV] = std::clamp(candidate[P::kBlurV], kMinBlurPx, kMaxBlurPx);
    Evaluation& trial = minimum->trial;
    trial.Run(problem, candidate, max_pixels);
    if (trial.num_pixels() > P::kCount && trial.Cost() < best.Cost()) {
      minimum->parameters = candidate;
      std::swap(best, trial);
      damping *= 0.1;
    } else {
      damping *= 10;
    }
    if (moved_px < tolerance_px) break;
  }
  return true;
}

// A quick fit on some pixels, then an exact one on more from there, with the surroundings read
// anew. False if there is no marker like this.
bool MinimizeInTwoPasses(const cv::Mat& cells, Problem* problem, Minimum* minimum) {
  for (const auto& [max_pixels, tolerance_px] :
       {std::pair(kFirstPixels, 0.05), std::pair(kPixels, 5e-3)}) {
    const P::Vector& p = minimum->parameters;
    FillLightness(*problem->gray, cells, UnitSquareMap(CornersOf(p)), p[P::kDark], p[P::kLight],
                  &problem->model);
    if (!Minimize(*problem, max_pixels, tolerance_px, minimum)) return false;
  }
  const double contrast = minimum->parameters[P::kLight] - minimum->parameters[P::kDark];
  return contrast > kMinContrast && minimum->at_parameters.Rms() < kMaxRelativeRms * contrast;
}

// The priors hold weak parameters but are no observations: their own error does not count.
std::optional<RefinedCorners> WithUncertainty(const Problem& problem, const Minimum& minimum) {
  const P::Matrix& hessian = minimum.at_parameters.hessian();
  const P::Matrix inverse = hessian.ldlt().solve(P::Matrix::Identity());
  if (!inverse.allFinite()) return std::nullopt;
  P::Matrix observed = hessian;
  observed.diagonal() -= problem.weight;
  const P::Matrix covariance = inverse * observed * inverse;
  const double variance_gray = minimum.at_parameters.Noise(inverse).VarianceGray();
  RefinedCorners refined{CornersOf(minimum.parameters), {}};
  for (int i = 0; i < kNumCorners; ++i) {
    const double trace = covariance.diagonal().segment<2>(2 * i).sum();
    refined.sigma_px[static_cast<std::size_t>(i)] = std::sqrt(0.5 * trace * variance_gray);
  }
  return refined;
}

}  // namespace

std::optional<RefinedCorners> FitPattern(const cv::Mat& gray, const Quad& corners_px,
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
  Minimum minimum{*start, {}, {}};
  if (!MinimizeInTwoPasses(cells, &problem, &minimum)) return std::nullopt;
  return WithUncertainty(problem, minimum);
}

}  // namespace velamap
