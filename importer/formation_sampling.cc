#include "importer/formation_sampling.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>
#include <opencv2/core.hpp>

#include "importer/detect/marker_alignment.h"
#include "importer/video/frame_source.h"

namespace velamap {
namespace {

constexpr std::size_t kMaxSamples = 32, kMinSamples = 4;
constexpr int kSamplesPerFrame = 4;
constexpr int kMaxFrames = 16;
constexpr int kVideoStride = 5;  // frames
constexpr double kMinSidePx = 12.0;
constexpr double kBestSidePx = 40.0;  // the fit of a larger marker takes longer and tells no more

// Prefers markers of a good size that have few samples yet.
void SortByPreference(const std::map<int, int>& num_samples_of, std::vector<MarkerQuad>* quads) {
  const auto preference = [&](const MarkerQuad& quad) {
    const double side_px = QuadMeanSide(quad.corners_px);
    const auto found = num_samples_of.find(quad.marker_id);
    const int num_samples = found == num_samples_of.end() ? 0 : found->second;
    return std::min(side_px / kBestSidePx, kBestSidePx / side_px) / (1 + num_samples);
  };
  std::stable_sort(quads->begin(), quads->end(), [&](const MarkerQuad& a, const MarkerQuad& b) {
    return preference(a) > preference(b);
  });
}

// The marker with its surroundings; nothing where its sides cannot be seen.
std::optional<FormationSample> CutSample(const FrameDetector& detector, const cv::Mat& gray,
                                         const MarkerQuad& quad) {
  const int reach_px = static_cast<int>(0.6 * QuadMeanSide(quad.corners_px)) + 8;
  const Box box = BoundingBox(quad.corners_px);
  const cv::Rect cut =
      cv::Rect(static_cast<int>(box.min.x()) - reach_px, static_cast<int>(box.min.y()) - reach_px,
               static_cast<int>(box.max.x() - box.min.x()) + 2 * reach_px,
               static_cast<int>(box.max.y() - box.min.y()) + 2 * reach_px) &
      cv::Rect({}, gray.size());
  FormationSample sample;
  sample.cells = detector.looks[static_cast<std::size_t>(quad.marker_id)].cells;
  sample.gray = gray(cut).clone();
  if (detector.options.inverted) cv::bitwise_not(sample.gray, sample.gray);
  QuadCorners corners_px = quad.corners_px;
  for (Eigen::Vector2d& corner : corners_px) corner -= Eigen::Vector2d(cut.x, cut.y);
  const auto aligned = AlignSides(sample.gray, corners_px, {sample.cells});
  if (!aligned) return std::nullopt;
  sample.corners_px = *aligned;
  return sample;
}

void AddSamples(const FrameDetector& detector, const cv::Mat& gray,
                std::map<int, int>* num_samples_of, std::vector<FormationSample>* samples) {
  std::vector<MarkerQuad> quads = SearchInFrame(detector, gray);
  SortByPreference(*num_samples_of, &quads);
  int num_added = 0;
  for (const MarkerQuad& quad : quads) {
    if (num_added == kSamplesPerFrame) break;
    const bool is_known =
        detector.part_of_id.empty() || detector.part_of_id.count(quad.marker_id) > 0;
    if (!is_known || QuadMeanSide(quad.corners_px) < kMinSidePx) continue;
    auto sample = CutSample(detector, gray, quad);
    if (!sample) continue;
    samples->push_back(std::move(*sample));
    ++(*num_samples_of)[quad.marker_id];
    ++num_added;
  }
}

}  // namespace

FormationEstimate EstimateFormationOfSource(const std::string& image_path,
                                            const VideoOptions& video, int num_threads,
                                            const FrameDetector& detector) {
  const std::unique_ptr<FrameSource> source = OpenFrameSource(image_path, video, {}, num_threads);
  const int stride =
      source->IsVideo() ? kVideoStride : std::max(1, source->NumFrames() / kMaxFrames);
  std::vector<FormationSample> samples;
  std::map<int, int> num_samples_of;
  int num_searched = 0;
  for (int idx = 0; num_searched < kMaxFrames && samples.size() < kMaxSamples; ++idx) {
    std::optional<Frame> frame = source->Next();
    if (!frame) break;
    std::string reason;
    if (idx % stride != 0 || !source->Load(&*frame, &reason)) continue;
    ++num_searched;
    AddSamples(detector, frame->gray, &num_samples_of, &samples);
  }
  FormationEstimate estimate;
  if (samples.size() >= kMinSamples) {
    estimate = EstimateFormation(samples, detector.options.inverted);
  }
  if (estimate.num_samples < static_cast<int>(kMinSamples)) return {};
  const ImageFormationParameters& found = estimate.parameters;
  spdlog::info(
      "camera and print, from {} markers: gamma {:.2f}, S-curve {:+.3f}, sharpening {:.2f} over "
      "{:.1f} px, ink spread {:+.2f} % of the side; residuals {:.1f} grey levels",
      estimate.num_samples, found.gamma, found.s_amplitude, found.sharpening,
      found.sharpening_radius_px, 100 * found.ink_spread_sides, estimate.noise_gray);
  return estimate;
}

}  // namespace velamap
