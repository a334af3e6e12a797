#include "importer/response_sampling.h"

#include <algorithm>
#include <map>
#include <memory>

#include <spdlog/spdlog.h>
#include <opencv2/core.hpp>

#include "importer/detect/marker_alignment.h"
#include "importer/video/frame_source.h"

namespace velamap {
namespace {

constexpr int kMaxSamples = 32;
constexpr int kSamplesPerFrame = 4;
constexpr int kMinSamples = 4;
constexpr int kMaxFrames = 16;   // that are searched
constexpr int kVideoStride = 5;  // frames
constexpr double kMinSidePx = 12.0;
constexpr double kBestSidePx = 40.0;  // larger ones tell no more and take longer

// How much a marker of this size tells for its cost.
double Preference(double side_px) { return std::min(side_px / kBestSidePx, kBestSidePx / side_px); }

void AddSamples(const FrameDetector& detector, const cv::Mat& gray,
                std::map<int, int>* num_of_marker, std::vector<ResponseSample>* samples) {
  std::vector<MarkerQuad> quads = SearchInFrame(detector, gray);
  std::stable_sort(quads.begin(), quads.end(), [&](const MarkerQuad& a, const MarkerQuad& b) {
    const auto rank = [&](const MarkerQuad& quad) {
      return Preference(QuadMeanSide(quad.corners_px)) / (1 + (*num_of_marker)[quad.marker_id]);
    };
    return rank(a) > rank(b);
  });
  int num_added = 0;
  for (const MarkerQuad& quad : quads) {
    if (num_added == kSamplesPerFrame) break;
    if (!detector.part_of_id.empty() && detector.part_of_id.count(quad.marker_id) == 0) continue;
    const double side_px = QuadMeanSide(quad.corners_px);
    if (side_px < kMinSidePx) continue;
    const Box box = BoundingBox(quad.corners_px);
    const cv::Point reach(static_cast<int>(0.6 * side_px) + 8, static_cast<int>(0.6 * side_px) + 8);
    const cv::Rect cut =
        cv::Rect(cv::Point(static_cast<int>(box.min.x()), static_cast<int>(box.min.y())) - reach,
                 cv::Point(static_cast<int>(box.max.x()), static_cast<int>(box.max.y())) + reach) &
        cv::Rect(0, 0, gray.cols, gray.rows);
    ResponseSample sample;
    const MarkerLook& look = detector.looks[static_cast<std::size_t>(quad.marker_id)];
    sample.cells = look.cells;
    sample.gray = gray(cut).clone();
    if (detector.options.inverted) cv::bitwise_not(sample.gray, sample.gray);
    sample.corners_px = quad.corners_px;
    for (Eigen::Vector2d& corner : sample.corners_px) corner -= Eigen::Vector2d(cut.x, cut.y);
    const auto aligned = AlignSides(sample.gray, sample.corners_px, {sample.cells});
    if (!aligned) continue;
    sample.corners_px = *aligned;
    samples->push_back(std::move(sample));
    ++(*num_of_marker)[quad.marker_id];
    ++num_added;
  }
}

}  // namespace

std::optional<ResponseEstimate> EstimateResponseOfSource(const MarkerImporterOptions& options,
                                                         const FrameDetector& detector) {
  const std::unique_ptr<FrameSource> source =
      OpenFrameSource(options.image_path, options.video, {}, options.num_threads);
  const int stride =
      source->IsVideo() ? kVideoStride : std::max(1, source->NumFrames() / kMaxFrames);
  std::vector<ResponseSample> samples;
  std::map<int, int> num_of_marker;
  int num_searched = 0;
  for (int idx = 0; num_searched < kMaxFrames && samples.size() < kMaxSamples; ++idx) {
    std::optional<Frame> frame = source->Next();
    if (!frame) break;
    if (idx % stride != 0) continue;
    std::string reason;
    if (!source->Load(&*frame, &reason)) continue;
    ++num_searched;
    AddSamples(detector, frame->gray, &num_of_marker, &samples);
  }
  if (samples.size() < kMinSamples) return std::nullopt;
  ResponseEstimate estimate = EstimateResponse(samples, detector.options.inverted);
  if (estimate.num_samples < kMinSamples) return std::nullopt;
  spdlog::info(
      "camera and print, from {} markers: gamma {:.2f}, S {:+.3f}, sharpening {:.2f} over {:.1f} "
      "px, "
      "ink {:+.2f} % of the side; {:.1f} grey levels left",
      estimate.num_samples, estimate.response.gamma, estimate.response.s_amplitude,
      estimate.response.sharpening, estimate.response.sharpening_radius_px,
      100 * estimate.spread_sides, estimate.rms);
  return estimate;
}

}  // namespace velamap
