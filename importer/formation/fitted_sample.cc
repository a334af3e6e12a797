#include "importer/formation/fitted_sample.h"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "importer/refine/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

// Modelled less recorded grey values. The patch is without the sharpening, which is applied to the
// difference again: it would otherwise depend on the sharpening how large the noise looks.
std::vector<float> ResidualsOf(const FittedSample& sample, const ImageFormation& formation) {
  const PatternProblem& problem = sample.problem;
  const PatternPicture picture(problem.model, sample.minimum.parameters);
  const cv::Point patch_from_box = problem.box.tl() - problem.patch.origin_px;
  const Eigen::Vector2d box_from_center =
      Eigen::Vector2d(problem.box.x, problem.box.y) - problem.model.center_px;
  cv::Mat difference = cv::Mat::zeros(problem.box.size(), CV_32F);
  PatternPixels modelled;
  for (std::size_t begin = 0; begin < sample.places.size(); begin += kLanes) {
    const std::size_t end = std::min(begin + kLanes, sample.places.size());
    Floats x{}, y{};
    for (std::size_t i = begin; i < end; ++i) {
      x[i - begin] = static_cast<float>(sample.places[i].x + box_from_center.x());
      y[i - begin] = static_cast<float>(sample.places[i].y + box_from_center.y());
    }
    picture.At(x, y, &modelled);
    for (std::size_t i = begin; i < end; ++i) {
      difference.at<float>(sample.places[i]) =
          modelled.gray[i - begin] -
          problem.patch.values.at<float>(sample.places[i] + patch_from_box);
    }
  }
  const ImageFormationParameters& parameters = formation.parameters();
  if (parameters.sharpening != 0) {
    cv::Mat slope(problem.box.size(), CV_32F, cv::Scalar(1));
    if (parameters.sharpens_light) {
      for (int y = 0; y < slope.rows; ++y) {
        for (int x = 0; x < slope.cols; ++x) {
          Floats one;
          formation.tone().Encode(AllLanes(formation.tone().Decode(problem.patch.values.at<float>(
                                      cv::Point(x, y) + patch_from_box))),
                                  &one);
          slope.at<float>(y, x) = one[0];
        }
      }
    }
    cv::Mat blurred;
    cv::divide(difference, slope, difference);
    cv::GaussianBlur(difference, blurred, {0, 0}, parameters.sharpening_radius_px,
                     parameters.sharpening_radius_px, cv::BORDER_CONSTANT);
    difference = (1 + parameters.sharpening) * difference - parameters.sharpening * blurred;
    cv::multiply(difference, slope, difference);
  }
  std::vector<float> residuals;
  residuals.reserve(sample.places.size());
  for (const cv::Point& place : sample.places) residuals.push_back(difference.at<float>(place));
  return residuals;
}

}  // namespace

std::optional<FittedSample> FitSample(const FormationSample& sample,
                                      const ImageFormation& formation) {
  FittedSample fitted;
  fitted.gray = sample.gray;
  auto problem =
      MakePatternProblem(sample.gray, sample.corners_px, sample.cells, formation, &fitted.minimum);
  if (!problem || !FitPatternInPasses(&*problem, &fitted.minimum)) return std::nullopt;
  fitted.problem = std::move(*problem);
  fitted.patch_box = cv::Rect(fitted.problem.patch.origin_px, fitted.problem.patch.values.size());
  const PatternPicture picture(fitted.problem.model, fitted.minimum.parameters);
  const Eigen::Vector2d& center = fitted.problem.model.center_px;
  for (int y = 0; y < fitted.problem.box.height; ++y) {
    for (int x = 0; x < fitted.problem.box.width; ++x) {
      if (picture.Covers(AllLanes(fitted.problem.box.x + x - center.x()),
                         AllLanes(fitted.problem.box.y + y - center.y()))[0]) {
        fitted.places.emplace_back(x, y);
      }
    }
  }
  return fitted;
}

void RefitSample(const ImageFormation& formation, const ToneCurve& before, FittedSample* sample) {
  constexpr int kMaxPixels = 4000;
  constexpr double kTolerancePx = 0.003;
  PatternProblem& problem = sample->problem;
  problem.patch = CutPatch(sample->gray, sample->patch_box, formation);
  problem.model.tone = &formation.tone();
  problem.model.ink_spread_cells =
      formation.parameters().ink_spread_sides * problem.model.num_cells;
  SetQuietZonePrior(formation.parameters(), &problem);
  for (const int index : {P::kDark, P::kLight}) {
    double& light = sample->minimum.parameters[index];
    light = formation.tone().Decode(before.Encode(light));
  }
  sample->residuals = RefinePatternFit(kMaxPixels, kTolerancePx, &problem, &sample->minimum)
                          ? ResidualsOf(*sample, formation)
                          : std::vector<float>();
}

}  // namespace velamap
