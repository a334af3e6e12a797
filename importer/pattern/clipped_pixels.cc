#include "importer/pattern/clipped_pixels.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "importer/pattern/pattern_picture.h"

namespace velamap {
namespace {

// Compression makes clipped areas a little uneven.
constexpr int kClippedWhite = 252, kClippedBlack = 3;

bool IsClipped(int gray) { return gray >= kClippedWhite || gray <= kClippedBlack; }

// The modelled grey values of the patch before the sharpening; those of the patch itself outside
// of the problem's box.
VELAMAP_CLONE_FOR_AVX2 cv::Mat ModelPatch(const PatternProblem& problem,
                                          const PatternParameters::Vector& parameters) {
  const PatternPicture picture(problem.model, parameters);
  const Eigen::Vector2d& center = problem.model.center_px;
  const cv::Rect& box = problem.box;
  cv::Mat modelled = problem.patch.values.clone();
  PatternPixels pixels;
  for (int y = box.y; y < box.y + box.height; ++y) {
    float* values = modelled.ptr<float>(y - problem.patch.origin_px.y);
    for (int begin = box.x; begin < box.x + box.width; begin += kLanes) {
      picture.At(static_cast<float>(begin - center.x()) + LaneIndex(), AllLanes(y - center.y()),
                 &pixels);
      const int count = std::min(kLanes, box.x + box.width - begin);
      for (int lane = 0; lane < count; ++lane) {
        values[begin + lane - problem.patch.origin_px.x] = pixels.gray[lane];
      }
    }
  }
  return modelled;
}

// Cuts the patch of the problem again. Replaces the clipped pixels of its box by the model's values
// where these are beyond the clipped ones. Returns false if there are none.
bool RestoreClippedPixels(const cv::Mat& gray, const ImageFormation& formation,
                          const PatternParameters::Vector& parameters, PatternProblem* problem) {
  const GrayPatch& patch = problem->patch;
  cv::Mat expected = ModelPatch(*problem, parameters);
  Sharpen(formation.parameters(), cv::BORDER_REPLICATE, &expected);
  const cv::Rect patch_box(patch.origin_px, patch.values.size());
  const cv::Point reach(PatchReachPx(formation), PatchReachPx(formation));
  const cv::Rect wide =
      cv::Rect(patch_box.tl() - reach, patch_box.br() + reach) & cv::Rect({}, gray.size());
  cv::Mat recorded;
  gray(wide).convertTo(recorded, CV_32F);
  cv::Mat is_clipped = cv::Mat::zeros(patch_box.size(), CV_8U);
  bool any = false;
  for (int y = problem->box.y; y < problem->box.y + problem->box.height; ++y) {
    for (int x = problem->box.x; x < problem->box.x + problem->box.width; ++x) {
      const int value = gray.at<std::uint8_t>(y, x);
      if (!IsClipped(value)) continue;
      const cv::Point in_patch = cv::Point(x, y) - patch_box.tl();
      const float model = expected.at<float>(in_patch);
      if (value >= kClippedWhite ? model <= static_cast<float>(value)
                                 : model >= static_cast<float>(value)) {
        continue;
      }
      recorded.at<float>(cv::Point(x, y) - wide.tl()) = model;
      is_clipped.at<std::uint8_t>(in_patch) = 1;
      any = true;
    }
  }
  GrayPatch restored = CutPatch(recorded, patch_box - wide.tl(), formation);
  restored.origin_px += wide.tl();
  restored.is_left_out = is_clipped;
  SetPatch(std::move(restored), problem);
  return any;
}

}  // namespace

bool HasClippedPixels(const cv::Mat& gray, const cv::Rect& box) {
  constexpr double kMaxShare = 0.2;
  int num_white = 0, num_black = 0;
  for (int row = box.y; row < box.y + box.height; ++row) {
    const auto* values = gray.ptr<std::uint8_t>(row) + box.x;
    for (int i = 0; i < box.width; ++i) {
      if (values[i] >= kClippedWhite) ++num_white;
      if (values[i] <= kClippedBlack) ++num_black;
    }
  }
  return num_white + num_black > 0 && std::min(num_white, num_black) < kMaxShare * box.area();
}

bool RefineBeyondClipping(const cv::Mat& gray, const ImageFormation& formation, int max_pixels,
                          double tolerance_px, PatternProblem* problem, PatternMinimum* minimum) {
  constexpr int kMaxRounds = 6;
  constexpr double kLeft = 3.0;  // after a slow round, this many of its steps remain
  constexpr double kMinStepRatio = 0.2, kMaxStepRatio = 0.9;
  PatternParameters::Vector last_step = PatternParameters::Vector::Zero();
  for (int round = 0; round < kMaxRounds; ++round) {
    const PatternParameters::Vector before = minimum->parameters;
    const bool is_restored = RestoreClippedPixels(gray, formation, before, problem);
    if (!RefinePatternFit(max_pixels, tolerance_px, problem, minimum)) return false;
    const PatternParameters::Vector step = minimum->parameters - before;
    const double step_px = step.head<2 * kNumCorners>().cwiseAbs().maxCoeff();
    if (!is_restored || kLeft * step_px < tolerance_px) break;
    // Aitken's extrapolation: the steps shrink by about the same ratio from round to round.
    const PatternParameters::Vector weight = minimum->equations.hessian().diagonal();
    const double ratio =
        step.dot(weight.cwiseProduct(last_step)) / last_step.dot(weight.cwiseProduct(last_step));
    last_step = step;
    const PatternParameters::Vector further = minimum->parameters + ratio / (1 - ratio) * step;
    if (ratio > kMinStepRatio && ratio < kMaxStepRatio && round + 1 < kMaxRounds &&
        further.segment<2>(PatternParameters::kBlurU).minCoeff() > 0) {
      minimum->parameters = further;
      last_step.setZero();
    }
  }
  return true;
}

}  // namespace velamap
