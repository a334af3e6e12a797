#include "importer/formation/fitted_sample.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "importer/formation/sample_bend.h"
#include "importer/pattern/clipped_pixels.h"
#include "importer/pattern/pattern_picture.h"

namespace velamap {
namespace {

using P = PatternParameters;

cv::Point PatchFromBox(const PatternProblem& problem) {
  return problem.box.tl() - problem.patch.origin_px;
}

// Modelled grey values minus those of the patch, from which the sharpening has been removed, in the
// box of the problem; zero for pixels that do not count.
VELAMAP_CLONE_FOR_AVX2 cv::Mat Differences(const FittedSample& sample) {
  const PatternProblem& problem = sample.problem;
  const PatternPicture picture(problem.model, sample.minimum.parameters);
  cv::Mat difference = cv::Mat::zeros(problem.box.size(), CV_32F);
  PatternPixels modelled;
  for (std::size_t begin = 0; begin < sample.places.size(); begin += kLanes) {
    const PlaceGroup group = PlaceGroupAt(sample, begin);
    picture.At(group.from_center_x_px, group.from_center_y_px, &modelled);
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const SamplePlace& place = sample.places[i];
      difference.at<float>(place.in_box) =
          modelled.gray[i - group.begin] - RecordedGray(sample, place);
    }
  }
  return difference;
}

// Modelled minus recorded grey values. The sharpening is applied to the differences again;
// otherwise the apparent noise would depend on the sharpening.
std::vector<float> ResidualsOf(const FittedSample& sample, const ImageFormation& formation) {
  cv::Mat difference = Differences(sample);
  Sharpen(formation.parameters(), cv::BORDER_CONSTANT, &difference);
  std::vector<float> residuals;
  residuals.reserve(sample.places.size());
  for (const SamplePlace& place : sample.places) {
    residuals.push_back(IsClipped(sample, place) ? 0.0f : difference.at<float>(place.in_box));
  }
  return residuals;
}

// Infinite without any.
double RmsOf(const std::vector<float>& residuals) {
  if (residuals.empty()) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const float residual : residuals) sum += static_cast<double>(residual) * residual;
  return std::sqrt(sum / static_cast<double>(residuals.size()));
}

// Another tone curve moves edges by a fraction of their blur. A fit that ends farther away has lost
// the marker, which happens where white is clipped.
bool HasRunAway(const FittedSample& sample) {
  constexpr double kMaxShiftPx = 2.0, kMaxShiftCells = 0.5;
  const QuadCorners found_px = CornersOf(sample.problem.mean);
  const double cell_px = QuadMeanSide(found_px) / sample.problem.model.num_cells;
  return !(MaxCornerShift(CornersOf(sample.minimum.parameters), found_px) <=
           std::max(kMaxShiftPx, kMaxShiftCells * cell_px));
}

}  // namespace

PlaceGroup PlaceGroupAt(const FittedSample& sample, std::size_t begin) {
  const PatternProblem& problem = sample.problem;
  const Eigen::Vector2d box_from_center =
      Eigen::Vector2d(problem.box.x, problem.box.y) - problem.model.center_px;
  PlaceGroup group;
  group.begin = begin;
  group.end = std::min(begin + kLanes, sample.places.size());
  for (std::size_t i = group.begin; i < group.end; ++i) {
    const cv::Point& in_box = sample.places[i].in_box;
    group.from_center_x_px[i - begin] = static_cast<float>(in_box.x + box_from_center.x());
    group.from_center_y_px[i - begin] = static_cast<float>(in_box.y + box_from_center.y());
  }
  return group;
}

float RecordedGray(const FittedSample& sample, const SamplePlace& place) {
  return sample.problem.patch.values.at<float>(place.in_box + PatchFromBox(sample.problem));
}

bool IsClipped(const FittedSample& sample, const SamplePlace& place) {
  const cv::Mat& is_left_out = sample.problem.patch.is_left_out;
  return !is_left_out.empty() &&
         is_left_out.at<std::uint8_t>(place.in_box + PatchFromBox(sample.problem)) != 0;
}

std::optional<FittedSample> FitSample(const FormationSample& sample,
                                      const ImageFormation& formation) {
  // Pixels of large markers beyond the reach of blur, sharpening and halo carry no information.
  constexpr float kReachOfEdgesPx = 16.0f;
  FittedSample fitted;
  fitted.gray = sample.gray;
  fitted.may_bend = sample.may_bend;
  fitted.lens_bend = sample.marker.lens_bend;
  auto problem =
      MakePatternProblem(sample.gray, sample.corners_px, sample.marker, formation, &fitted.minimum);
  if (!problem || !FitPatternInPasses(&*problem, &fitted.minimum)) return std::nullopt;
  fitted.problem = std::move(*problem);
  const PatternPicture picture(fitted.problem.model, fitted.minimum.parameters);
  const Eigen::Vector2d& center = fitted.problem.model.center_px;
  for (int y = 0; y < fitted.problem.box.height; ++y) {
    for (int x = 0; x < fitted.problem.box.width; ++x) {
      const Floats from_center_x = AllLanes(fitted.problem.box.x + x - center.x());
      const Floats from_center_y = AllLanes(fitted.problem.box.y + y - center.y());
      if (!picture.Covers(from_center_x, from_center_y)[0] ||
          !picture.IsNearEdge(from_center_x, from_center_y, kReachOfEdgesPx)[0]) {
        continue;
      }
      const bool is_at_corner = picture.IsAtOutlineCorner(from_center_x, from_center_y)[0] != 0;
      fitted.places.push_back({{x, y}, is_at_corner});
    }
  }
  return fitted;
}

void RefitSample(const ImageFormation& formation, const ToneCurve& before, FittedSample* sample) {
  constexpr int kMaxPixels = 4000;
  constexpr double kTolerancePx = 0.003;
  constexpr double kDiverged = 3.0;  // times the residuals before
  PatternProblem& problem = sample->problem;
  const cv::Rect patch_box(problem.patch.origin_px, problem.patch.values.size());
  SetPatch(CutPatch(sample->gray, patch_box, formation), &problem);
  SetFormation(formation, &problem);
  SetQuietZonePrior(formation.parameters(), &problem);
  for (const int index : {P::kDark, P::kLight}) {
    double& light = sample->minimum.parameters[index];
    light = formation.tone().Decode(before.Encode(light));
  }
  const P::Vector start = sample->minimum.parameters;
  const PatternBend start_bend = problem.model.lens_bend;
  const double rms_before = RmsOf(sample->residuals);
  bool is_fitted = HasClippedPixels(sample->gray, problem.box)
                       ? RefineBeyondClipping(sample->gray, formation, kMaxPixels, kTolerancePx,
                                              &problem, &sample->minimum)
                       : RefinePatternFit(kMaxPixels, kTolerancePx, &problem, &sample->minimum);
  if (is_fitted && sample->may_bend) is_fitted = FollowBend(kMaxPixels, kTolerancePx, sample);
  sample->minimum.equations = {};  // large, and samples are copied
  sample->residuals.clear();
  if (is_fitted && !HasRunAway(*sample)) sample->residuals = ResidualsOf(*sample, formation);
  if (!(RmsOf(sample->residuals) < kDiverged * rms_before)) sample->residuals.clear();
  if (sample->residuals.empty()) {
    sample->minimum.parameters = start;
    problem.model.lens_bend = start_bend;
  }
}

}  // namespace velamap
