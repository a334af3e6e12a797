#include "importer/pattern/pattern_fit.h"

#include <cmath>
#include <cstdint>

#include <Eigen/Cholesky>

#include "importer/base/error.h"
#include "importer/geometry/unit_square_map.h"
#include "importer/pattern/clipped_pixels.h"
#include "importer/pattern/foreign_pixels.h"
#include "importer/pattern/lighting_fit.h"
#include "importer/pattern/pattern_picture.h"
#include "importer/pattern/pattern_problem.h"

namespace velamap {
namespace {

using P = PatternParameters;

// `inverse` of the Hessian.
VELAMAP_CLONE_FOR_AVX2 ResidualNoise NoiseOf(const PatternEquations& equations,
                                             const P::Matrix& inverse) {
  return equations.Noise(
      inverse, [](const PatternEquations::Jacobian& jacobian) { return SquaredSlope(jacobian); });
}

// The priors stabilize weak parameters but are not observations, so their errors do not count.
std::optional<RefinedCorners> WithUncertainty(const PatternProblem& problem,
                                              const PatternMinimum& minimum,
                                              const Lighting& lighting) {
  const Eigen::LLT<P::Matrix> factors(minimum.equations.hessian());
  if (factors.info() != Eigen::Success) return std::nullopt;
  P::Matrix inverse = factors.solve(P::Matrix::Identity());
  if (!inverse.allFinite()) return std::nullopt;
  const ResidualNoise noise = NoiseOf(minimum.equations, inverse);
  inverse += AddedByLighting(problem, minimum, lighting);
  // The diagonal of inverse * (hessian - weight) * inverse.
  const P::Vector variances = inverse.diagonal() - inverse.cwiseAbs2().lazyProduct(problem.weight);
  RefinedCorners refined;
  refined.corners_px = CornersOf(minimum.parameters);
  for (int i = 0; i < kNumCorners; ++i) {
    refined.sigma_px[static_cast<std::size_t>(i)] =
        std::sqrt(0.5 * variances.segment<2>(2 * i).sum() * noise.VarianceGray());
  }
  return refined;
}

// Column and row of each cell in the middle of which the image is darker than the model of a light
// cell, or lighter than the model of a dark cell, by more than a quarter of the contrast. An object
// in front of the marker may cause this as well as a misread code.
VELAMAP_CLONE_FOR_AVX2 std::vector<cv::Point> MismatchedCells(const PatternProblem& problem,
                                                              const PatternMinimum& minimum) {
  constexpr double kMismatch = 0.25;  // of the contrast
  const double limit_gray = kMismatch * ContrastOf(problem, minimum);
  const P::Vector& parameters = minimum.parameters;
  const PatternPicture picture(problem.model, parameters);
  const UnitSquareMap map(CornersOf(parameters));
  const int n = problem.model.num_cells;
  std::vector<cv::Point> mismatched;
  PatternPixels modelled;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const double u = (column + 0.5) / n, v = (row + 0.5) / n;
      const Eigen::Vector2d x_px =
          map.ToImage(u, v) + 4 * u * (1 - u) * parameters.segment<2>(P::kBendU) +
          4 * v * (1 - v) * parameters.segment<2>(P::kBendV) + problem.model.lens_bend.At(u, v);
      const Eigen::Vector2d place = x_px - problem.model.center_px;
      picture.At(AllLanes(place.x()), AllLanes(place.y()), &modelled);
      const double excess_gray = InterpolatePatch(problem.patch, x_px) - modelled.gray[0];
      const bool is_light = problem.cells.at<std::uint8_t>(row, column) != 0;
      if ((is_light ? -excess_gray : excess_gray) > limit_gray) {
        mismatched.emplace_back(column, row);
      }
    }
  }
  return mismatched;
}

}  // namespace

std::optional<RefinedCorners> FitPattern(const cv::Mat& gray, const QuadCorners& corners_px,
                                         const KnownMarker& marker,
                                         const ImageFormation& formation) {
  const cv::Mat& cells = marker.cells;
  VELAMAP_CHECK(gray.type() == CV_8UC1 && cells.type() == CV_8UC1 && cells.rows == cells.cols);
  PatternMinimum minimum;
  std::optional<PatternProblem> problem =
      MakePatternProblem(gray, corners_px, marker, formation, &minimum);
  if (!problem || !FitPatternInPasses(&*problem, &minimum)) return std::nullopt;
  const double rms_gray = minimum.equations.Rms();
  const auto refine_beyond_clipping = [&] {
    return !HasClippedPixels(gray, problem->box) ||
           RefineBeyondClipping(gray, formation, kMaxPatternPixels, kPatternTolerancePx, &*problem,
                                &minimum);
  };
  // A single cell of the wrong colour leaves a larger residual.
  constexpr double kLargeRms = 0.05;  // of the contrast
  const auto mismatched = [&] {
    return rms_gray > kLargeRms * ContrastOf(*problem, minimum) ? MismatchedCells(*problem, minimum)
                                                                : std::vector<cv::Point>();
  };
  if (!refine_beyond_clipping()) return std::nullopt;
  // A lighting might explain a cell of the wrong colour.
  const std::vector<cv::Point> mismatched_in_even_light = mismatched();
  const Lighting lighting = FitLighting(&*problem, &minimum);
  if ((!lighting.IsEven() && !refine_beyond_clipping()) ||
      !RefitWithoutForeignPixels(&*problem, &minimum)) {
    return std::nullopt;
  }
  auto refined = WithUncertainty(*problem, minimum, lighting);
  if (!refined) return std::nullopt;
  refined->rms_gray = rms_gray;
  refined->mismatched_cells = lighting.IsEven() ? mismatched() : mismatched_in_even_light;
  return refined;
}

}  // namespace velamap
