#include "importer/pattern/foreign_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "importer/base/statistics.h"
#include "importer/pattern/pattern_pixels.h"

namespace velamap {
namespace {

using P = PatternParameters;

// The smallest residual of a foreign pixel, grey levels. It is a multiple of the noise of pixels on
// edges, so a model that misses all edges slightly does not make them foreign. Returns nothing for
// too few pixels.
std::optional<double> ForeignLimit(const std::vector<PixelResidual>& residuals, double contrast) {
  constexpr double kContrast = 0.1, kSigmas = 6.0;
  constexpr double kEdgeSlope = 0.05;  // of the contrast per pixel
  std::vector<double> on_edges;
  for (const PixelResidual& residual : residuals) {
    if (residual.slope_gray_per_px > kEdgeSlope * contrast) {
      on_edges.push_back(residual.absolute_gray);
    }
  }
  if (on_edges.size() <= static_cast<std::size_t>(P::kCount)) return std::nullopt;
  return std::max(kContrast * contrast, kSigmas * kMadToSigma * Median(on_edges));
}

double ShareBeyond(double limit, const std::vector<PixelResidual>& residuals) {
  const auto count =
      std::count_if(residuals.begin(), residuals.end(),
                    [&](const PixelResidual& residual) { return residual.absolute_gray > limit; });
  return static_cast<double>(count) / static_cast<double>(residuals.size());
}

// Marks (8 bit) the pixels of the patch whose residual exceeds the limit, and the pixels around
// them that the blur affects.
cv::Mat ForeignPixels(const PatternProblem& problem, const P::Vector& parameters, double limit) {
  constexpr double kReach = 2.0;  // blur sigmas
  constexpr int kMaxReachPx = 4;
  cv::Mat is_foreign = cv::Mat::zeros(problem.patch.values.size(), CV_8U);
  const ChosenPixels all = ChoosePixels(problem, parameters, std::numeric_limits<int>::max());
  for (const PixelResidual& residual : Residuals(problem, parameters, all)) {
    if (residual.absolute_gray > limit) is_foreign.at<std::uint8_t>(residual.in_patch) = 1;
  }
  const double blur_px = parameters.segment<2>(P::kBlurU).mean();
  const int reach_px = std::min(kMaxReachPx, static_cast<int>(std::ceil(kReach * blur_px)));
  cv::dilate(
      is_foreign, is_foreign,
      cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * reach_px + 1, 2 * reach_px + 1)));
  return is_foreign;
}

bool AreSame(const cv::Mat& mask1, const cv::Mat& mask2) {
  return mask1.size() == mask2.size() && cv::norm(mask1, mask2, cv::NORM_L1) == 0;
}

}  // namespace

bool RefitWithoutForeignPixels(PatternProblem* problem, PatternMinimum* minimum) {
  constexpr double kMinShare = 0.004, kMaxShare = 0.35;
  constexpr int kMaxRounds = 6;  // foreign pixels that have moved the first fit hide each other
  const cv::Mat clipped = problem->patch.is_left_out;
  cv::Mat is_foreign;
  for (int round = 0; round < kMaxRounds; ++round) {
    problem->patch.is_left_out = clipped;
    const std::vector<PixelResidual> residuals =
        Residuals(*problem, minimum->parameters,
                  ChoosePixels(*problem, minimum->parameters, kMaxPatternPixels));
    const auto limit = ForeignLimit(residuals, ContrastOf(*problem, *minimum));
    if (!limit) return false;
    const double share = ShareBeyond(*limit, residuals);
    if (share < kMinShare) return true;
    if (share > kMaxShare) return round == 0;  // later, the refit has lost the marker
    const cv::Mat last = is_foreign;
    is_foreign = ForeignPixels(*problem, minimum->parameters, *limit);
    problem->patch.is_left_out = clipped.empty() ? is_foreign : cv::Mat(clipped | is_foreign);
    if (AreSame(is_foreign, last)) return true;
    if (!RefinePatternFit(kMaxPatternPixels, kPatternTolerancePx, problem, minimum)) return false;
  }
  return true;
}

}  // namespace velamap
