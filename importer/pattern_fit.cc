#include "importer/pattern_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "importer/blurred_cells.h"
#include "importer/error.h"
#include "importer/interpolate.h"
#include "importer/unit_square_map.h"

namespace velamap {
namespace {

using Quad = std::array<Eigen::Vector2d, kNumCorners>;

constexpr double kMarginInCells = 0.75;  // how far outside the black square pixels are used
constexpr double kMinContrast = 12.0;    // grey levels
constexpr double kMaxRelativeRms = 0.2;  // of the residuals, by contrast
constexpr double kPixelNoise = 3.0;      // grey levels, against which the priors weigh
constexpr double kMinBlurPx = 0.3;
constexpr double kMaxBlurPx = 4.0;
constexpr int kMaxIterations = 10;
constexpr int kFirstPixels = 200;
constexpr int kPixels = 700;

// 0..7: corners (x0 y0 x1 y1 ...), px.
enum Parameter {
  kBlurU = 8,
  kBlurV,
  kDark,
  kLight,
  kGradientX,
  kGradientY,
  kSurround,    // contrast of the surroundings in parts of what the blurred image shows there
  kInnerLight,  // lightness of the marker's own light cells in parts of the quiet zone's
  kNumParameters
};
using Vector = Eigen::Matrix<double, kNumParameters, 1>;
using Matrix = Eigen::Matrix<double, kNumParameters, kNumParameters>;

struct Problem {
  const cv::Mat* gray;
  cv::Rect box;
  int num_cells;
  // Of column i, row j at (j + kRing, i + kRing): the marker's own cells; all that lies outside, as
  // if it were light; and what the surroundings depart from that.
  Lightness inner, ring, surround;
  Eigen::Vector2d center_px;
  double side_px;
  Vector mean, weight;  // priors
};

Quad CornersOf(const Vector& parameters) {
  Quad quad;
  for (int i = 0; i < kNumCorners; ++i) {
    quad[static_cast<std::size_t>(i)] = parameters.segment<2>(2 * i);
  }
  return quad;
}

// Sums J^T J and J^T r over pixels, many at a time because the product of matrices is fast.
class NormalEquations {
 public:
  void Add(const Vector& jacobian, double residual) {
    jacobians_.col(num_waiting_) = jacobian.cast<float>();
    residuals_[num_waiting_] = residual;
    ++num_pixels_;
    if (++num_waiting_ == kBlock) Flush();
  }

  void Finish(const Problem& problem, const Vector& parameters) {
    Flush();
    const Vector departure = parameters - problem.mean;
    hessian_.diagonal() += problem.weight;
    gradient_ += problem.weight.cwiseProduct(departure);
    prior_cost_ = departure.cwiseAbs2().dot(problem.weight);
  }

  const Matrix& hessian() const { return hessian_; }
  const Vector& gradient() const { return gradient_; }
  int num_pixels() const { return num_pixels_; }
  double Rms() const { return std::sqrt(squared_residuals_ / num_pixels_); }
  double Cost() const { return (squared_residuals_ + prior_cost_) / num_pixels_; }

 private:
  static constexpr int kBlock = 48;

  void Flush() {
    jacobians_.rightCols(kBlock - num_waiting_).setZero();
    residuals_.tail(kBlock - num_waiting_).setZero();
    hessian_ += (jacobians_ * jacobians_.transpose()).cast<double>();
    gradient_ += (jacobians_ * residuals_.cast<float>()).cast<double>();
    squared_residuals_ += residuals_.squaredNorm();
    num_waiting_ = 0;
  }

  Eigen::Matrix<float, kNumParameters, kBlock> jacobians_;
  Eigen::Matrix<double, kBlock, 1> residuals_;
  int num_waiting_ = 0;
  Matrix hessian_ = Matrix::Zero();
  Vector gradient_ = Vector::Zero();
  double squared_residuals_ = 0.0;
  double prior_cost_ = 0.0;
  int num_pixels_ = 0;
};

void AddPixel(const Problem& problem, const UnitSquareMap& map, const Vector& p,
              const Eigen::Vector2d& x_px, double gray, NormalEquations* equations) {
  const Eigen::Vector2d uv = map.ToSquare(x_px);
  const double n = problem.num_cells;
  const double margin = kMarginInCells / n;
  if (!(uv.minCoeff() > -margin && uv.maxCoeff() < 1 + margin)) return;
  const Eigen::Matrix2d gradient = n * map.SquareGradient(x_px);  // cells/px
  const double cells_u = gradient.row(0).norm(), cells_v = gradient.row(1).norm();
  Shares u, v;
  ComputeShares(n * uv.x(), cells_u * p[kBlurU], problem.num_cells, &u);
  ComputeShares(n * uv.y(), cells_v * p[kBlurV], problem.num_cells, &v);
  const Blended inner = Blend(problem.inner, u, v);
  Blended pattern;
  Add(p[kInnerLight], inner, &pattern);
  const int n_cells = problem.num_cells;
  if (Reaches(kRing, u, n_cells) || Reaches(kRing, v, n_cells)) {
    Add(1.0, Blend(problem.ring, u, v), &pattern);
  }
  AddCorrelation(p[kBlurU] * p[kBlurV] * gradient.row(0).dot(gradient.row(1)), &pattern);
  double surround = 0.0;
  if (Reaches(1, u, n_cells) || Reaches(1, v, n_cells)) {
    const Blended around = Blend(problem.surround, u, v);
    surround = around.value;
    Add(p[kSurround], around, &pattern);
  }

  const Eigen::Vector2d place = (x_px - problem.center_px) / problem.side_px;
  const double light = 1 + p[kGradientX] * place.x() + p[kGradientY] * place.y();
  const double contrast = light * (p[kLight] - p[kDark]);
  const double level = p[kDark] + (p[kLight] - p[kDark]) * pattern.value;
  const Eigen::Vector2d by_place =
      contrast * gradient.transpose() * Eigen::Vector2d(pattern.by_u, pattern.by_v);
  // A corner that moves takes each place along by its bilinear share, nearly enough for a step.
  const std::array<double, kNumCorners> share = {(1 - uv.x()) * (1 - uv.y()), uv.x() * (1 - uv.y()),
                                                 uv.x() * uv.y(), (1 - uv.x()) * uv.y()};
  Vector jacobian;
  for (int i = 0; i < kNumCorners; ++i) {
    jacobian.segment<2>(2 * i) = -share[static_cast<std::size_t>(i)] * by_place;
  }
  jacobian[kBlurU] = contrast * cells_u * pattern.by_blur_u;
  jacobian[kBlurV] = contrast * cells_v * pattern.by_blur_v;
  jacobian[kDark] = light * (1 - pattern.value);
  jacobian[kLight] = light * pattern.value;
  jacobian[kGradientX] = level * place.x();
  jacobian[kGradientY] = level * place.y();
  jacobian[kSurround] = contrast * surround;
  jacobian[kInnerLight] = contrast * inner.value;
  equations->Add(jacobian, light * level - gray);
}

// Every k-th pixel, so many that about `max_pixels` are used.
NormalEquations Accumulate(const Problem& problem, const Vector& parameters, int max_pixels) {
  NormalEquations equations;
  const UnitSquareMap map(CornersOf(parameters));
  const cv::Rect& box = problem.box;
  const double area_px = 1.2 * problem.side_px * problem.side_px;
  const int stride = static_cast<int>(std::ceil(area_px / max_pixels));
  for (int row = box.y; row < box.y + box.height; ++row) {
    const std::uint8_t* pixels = problem.gray->ptr<std::uint8_t>(row);
    // Odd rows are shifted, so that every column has its share.
    const int first = box.x + (row * ((stride + 1) / 2)) % stride;
    for (int column = first; column < box.x + box.width; column += stride) {
      AddPixel(problem, map, parameters, {column, row}, pixels[column], &equations);
    }
  }
  equations.Finish(problem, parameters);
  return equations;
}

// Cells, quiet zone and, from the image, what surrounds it.
void FillLightness(const cv::Mat& cells, const UnitSquareMap& map, double dark, double light,
                   Problem* problem) {
  const int n = problem->num_cells;
  for (int j = -kRing; j < n + kRing; ++j) {
    for (int i = -kRing; i < n + kRing; ++i) {
      const int outside = std::max({-i, i - n + 1, -j, j - n + 1});
      double lightness = 0.0, ring = outside > 0, surround = 0.0;
      if (outside <= 0) {
        lightness = cells.at<std::uint8_t>(j, i) != 0;
      } else if (outside == kRing) {
        const double value =
            InterpolateGray(*problem->gray, map.ToImage((i + 0.5) / n, (j + 0.5) / n));
        surround = std::clamp((value - light) / (light - dark), -1.0, 0.2);
      }
      problem->inner(j + kRing, i + kRing) = lightness;
      problem->ring(j + kRing, i + kRing) = ring;
      problem->surround(j + kRing, i + kRing) = surround;
    }
  }
}

// Levels that explain the pixels best while the corners stay.
std::optional<Vector> Start(const cv::Mat& cells, const Quad& corners, Problem* problem) {
  Vector p = Vector::Zero();
  for (int i = 0; i < kNumCorners; ++i) {
    p.segment<2>(2 * i) = corners[static_cast<std::size_t>(i)];
  }
  p[kBlurU] = p[kBlurV] = p[kSurround] = p[kInnerLight] = 1.0;
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  const UnitSquareMap map(corners);
  const int n = problem->num_cells;
  for (int j = -1; j <= n; ++j) {
    for (int i = -1; i <= n; ++i) {
      const bool inside = i >= 0 && j >= 0 && i < n && j < n;
      const int is_light = !inside || cells.at<std::uint8_t>(j, i) != 0;
      sum[is_light] += InterpolateGray(*problem->gray, map.ToImage((i + 0.5) / n, (j + 0.5) / n));
      ++count[is_light];
    }
  }
  p[kDark] = sum[0] / count[0];
  p[kLight] = sum[1] / count[1];
  if (!(p[kLight] - p[kDark] > kMinContrast / 2)) return std::nullopt;
  problem->mean = p;
  Vector sigma;
  sigma << Vector::Constant(1e3).head<8>(), 0.7, 0.7, 1e3, 1e3, 0.15, 0.15, 0.3, 0.1;
  problem->weight = (kPixelNoise * sigma.cwiseInverse()).cwiseAbs2();
  return p;
}

struct Minimum {
  Vector parameters;
  double rms_gray;
};

// Levenberg-Marquardt over about `max_pixels` pixels until a step moves no corner further than
// `tolerance_px`.
std::optional<Minimum> Minimize(const Problem& problem, Vector p, int max_pixels,
                                double tolerance_px) {
  NormalEquations equations = Accumulate(problem, p, max_pixels);
  double damping = 1e-3;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (equations.num_pixels() <= kNumParameters) return std::nullopt;
    Matrix damped = equations.hessian();
    damped.diagonal() *= 1 + damping;
    const Vector step = -damped.selfadjointView<Eigen::Lower>().ldlt().solve(equations.gradient());
    if (!step.allFinite()) return std::nullopt;
    const double moved_px = step.head<8>().cwiseAbs().maxCoeff();
    Vector candidate = p + step;
    candidate[kBlurU] = std::clamp(candidate[kBlurU], kMinBlurPx, kMaxBlurPx);
    candidate[kBlurV] = std::clamp(candidate[kBlurV], kMinBlurPx, kMaxBlurPx);
    const NormalEquations next = Accumulate(problem, candidate, max_pixels);
    if (next.num_pixels() > kNumParameters && next.Cost() < equations.Cost()) {
      p = candidate;
      equations = next;
      damping *= 0.1;
    } else {
      damping *= 10;
    }
    if (moved_px < tolerance_px) break;
  }
  return Minimum{p, equations.Rms()};
}

// A quick fit on some pixels, then an exact one on more from there, with the surroundings read
// anew.
std::optional<Vector> MinimizeInTwoPasses(const cv::Mat& cells, const Vector& start,
                                          Problem* problem) {
  Minimum minimum{start, 0.0};
  for (const auto& [max_pixels, tolerance_px] :
       {std::pair(kFirstPixels, 0.05), std::pair(kPixels, 5e-3)}) {
    const Vector& p = minimum.parameters;
    FillLightness(cells, UnitSquareMap(CornersOf(p)), p[kDark], p[kLight], problem);
    const auto next = Minimize(*problem, p, max_pixels, tolerance_px);
    if (!next) return std::nullopt;
    minimum = *next;
  }
  const double contrast = minimum.parameters[kLight] - minimum.parameters[kDark];
  if (!(contrast > kMinContrast && minimum.rms_gray < kMaxRelativeRms * contrast)) {
    return std::nullopt;
  }
  return minimum.parameters;
}

}  // namespace

std::optional<Quad> FitPattern(const cv::Mat& gray, const Quad& corners_px, const cv::Mat& cells) {
  VELAMAP_CHECK(gray.type() == CV_8UC1 && cells.type() == CV_8UC1 && cells.rows == cells.cols);
  Problem problem;
  problem.gray = &gray;
  problem.num_cells = cells.rows;
  if (problem.num_cells + 2 * kRing > kMaxRingedCells) return std::nullopt;
  const UnitSquareMap map(corners_px);
  const double reach = 1.0 / problem.num_cells;
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
  problem.center_px = map.ToImage(0.5, 0.5);
  problem.side_px =
      0.5 * ((corners_px[2] - corners_px[0]).norm() + (corners_px[3] - corners_px[1]).norm());
  const auto start = Start(cells, corners_px, &problem);
  if (!start) return std::nullopt;
  const auto fitted = MinimizeInTwoPasses(cells, *start, &problem);
  if (!fitted) return std::nullopt;
  return CornersOf(*fitted);
}

}  // namespace velamap
